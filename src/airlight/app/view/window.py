"""The viewer in a window of the desktop (glfw)."""

from __future__ import annotations

import os
import sys

from ...errors import DeviceError
from .canvas import canvas_view, close_on_signals, missing
from .session import Session


def open_window(session: Session, size: tuple[int, int]) -> None:
    """Show `session` until the window is closed. Raises AirlightError without glfw or a display."""
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        raise DeviceError(
            "there is no display to open a window on",
            remedy="Use --in browser, over an SSH tunnel if this is a remote machine",
        )
    try:
        import glfw
        from rendercanvas.glfw import RenderCanvas, loop
        from rendercanvas.utils.asyncs import sleep
    except ImportError as error:
        raise missing(error.name or "glfw") from None
    session.prepare(size)
    title = f"{session.state.scene.name} - airlight"
    try:
        canvas = RenderCanvas(size=size, title=title, max_fps=60, update_mode="ondemand")
    except Exception as error:
        raise DeviceError(
            f"the window cannot be opened: {error}", remedy="Use --in browser"
        ) from None

    def copy(text: str) -> None:
        glfw.set_clipboard_string(canvas._window, text)

    view = canvas_view(canvas, session, copy=copy)
    loop.add_task(close_on_signals, canvas, name="close on signals")
    loop.add_task(view.watch, sleep, name="watch the scene file")
    loop.run()
    session.close()
