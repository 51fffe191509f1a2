"""The viewer in a browser: images over a websocket, from this machine or through a tunnel."""

from __future__ import annotations

import html
import logging
import os
import socket
import warnings
import webbrowser
from typing import Any

import click

from .canvas import CanvasView, close_on_signals, missing
from .guard import Guard, bound_socket, is_loopback, new_token
from .messages import believed
from .page import Page, web_text
from .session import Session

_LARGEST_MESSAGE = 1 << 16  # bytes that a browser may send at once
_SERVING: dict[str, Any] = {
    "log_level": "error",
    "lifespan": "on",
    "ws_max_size": _LARGEST_MESSAGE,
    "timeout_graceful_shutdown": 1,
    "access_log": False,
}
_SERVER = 0  # the id of what the server itself says; browsers count from 1

FILES = {
    "index.html": "text/html; charset=utf-8",
    "panel.css": "text/css; charset=utf-8",
    "panel.js": "text/javascript; charset=utf-8",
    "page.js": "text/javascript; charset=utf-8",
}


def serve(
    session: Session,
    size: tuple[int, int],
    *,
    port: int = 0,
    listen: str = "",
    opens: bool = False,
) -> None:
    """Serve `session` until interrupted; the link goes to stdout.

    Raises AirlightError where a package is missing, the port is in use or the address is not
    this machine's.
    """
    try:
        import uvicorn
        from rendercanvas import http
        from rendercanvas.utils.asyncs import sleep
    except ImportError as error:
        raise missing(error.name or "uvicorn") from None
    # The port first: where it is taken, nothing was made in vain.
    bound = bound_socket(listen, port)
    session.prepare(size)
    token = new_token()
    page = Page(session, http.asgi.send_all)
    canvas = make_canvas(http, session, size, page)
    view = CanvasView(canvas, session, page.saver, page)
    page.touched = view.touched
    # The loop's tasks: closing by signals, and watching the scene file.
    http.loop.add_task(close_on_signals, canvas, name="close on signals")
    http.loop.add_task(view.watch, sleep, name="watch the scene file")
    guard = Guard(http.asgi, token, listen)
    server = uvicorn.Server(uvicorn.Config(guard, **_SERVING))

    def stop(event: dict[str, Any]) -> None:
        server.should_exit = True

    # The window's close ends the server, and the server's end closes everything.
    canvas.add_event_handler(stop, "close")
    logging.getLogger("rendercanvas").setLevel(logging.ERROR)
    # Of rendercanvas, where a page is open when it closes.
    warnings.filterwarnings("ignore", message="coroutine 'Queue.put' was never awaited")
    # Whoever has the link may look and steer, so it holds a token.
    link = link_to(bound, token)
    say_where(link, bound.getsockname()[1], listen)
    if opens and not os.environ.get("SSH_CONNECTION"):
        webbrowser.open(link)
    try:
        server.run(sockets=[bound])
    except KeyboardInterrupt:
        pass
    finally:
        bound.close()
        page.uploads.close()
        session.close()
    click.echo("stopped", err=True)


def make_canvas(http: Any, session: Session, size: tuple[int, int], page: Page) -> Any:
    """A canvas of `rendercanvas.http` that does not believe everything a browser says."""

    sizes: dict[int, dict[str, Any]] = {}

    class GuardedCanvas(http.HttpRenderCanvas):  # type: ignore[misc]
        def _on_event(self, event: dict[str, Any], id: int) -> None:
            # Who looks on may ask what stands in the panel, and change nothing.
            is_asking = isinstance(event, dict) and event.get("type") == "hello"
            if is_asking and id != self._active_client:
                event = {**event, "shown": page.is_shown}
            if (is_asking or id == self._active_client) and page.heard(event):
                return
            # What a page sends is checked; the server's own events need no check.
            kept = event if id == _SERVER else believed(event)
            if kept is None:
                return
            if kept["type"] == "resize":
                sizes[id] = kept
            steering = self._active_client
            super()._on_event(kept, id)
            if self._active_client != steering:
                # Who steered is gone: no button of theirs is held, and another's size counts.
                session.release()
                if self._active_client in sizes:
                    super()._on_event(sizes[self._active_client], self._active_client)

    title = f"{session.state.scene.name} - airlight"
    # Each page has the scene's name, escaped, as its title.
    for name, kind in FILES.items():
        text = web_text(name).replace("<title>airlight", f"<title>{html.escape(title)}")
        http.resources[name] = (kind, text)
    canvas = GuardedCanvas(size=size, title=title, max_fps=30, update_mode="ondemand")
    canvas._size_info.set_physical_size(*size, 1.0)
    return canvas


def link_to(bound: socket.socket, token: str) -> str:
    """The address to open, with its token."""
    # Listening on all addresses, the machine's name is what others can open.
    host, port = bound.getsockname()[:2]
    if host in ("0.0.0.0", "::"):
        host = socket.gethostname()
    host = f"[{host}]" if ":" in host else host
    return f"http://{host}:{port}/{token}/"


def say_where(link: str, port: int, listen: str) -> None:
    """The link on stdout; on stderr what it exposes, or how to come to it from afar."""
    click.echo(link)
    if not is_loopback(listen):
        click.echo(
            f"warning: served on {listen}: whoever gets the link can look and steer, and it is "
            "not encrypted. Without --listen, only this machine can reach it.",
            err=True,
        )
    elif os.environ.get("SSH_CONNECTION"):
        click.echo(
            f"On the machine before you: ssh -N -L {port}:127.0.0.1:{port} {socket.gethostname()}",
            err=True,
        )
    click.echo("Ctrl-C ends it.", err=True)
