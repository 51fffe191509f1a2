"""The viewer in a window of the desktop (glfw)."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from ...errors import DeviceError
from .asking import Asking
from .canvas import CanvasView, close_on_signals, missing
from .save import Saver
from .session import Session


def open_window(session: Session, size: tuple[int, int]) -> None:
    """Show `session` until the window is closed. Raises AirlightError without glfw or a display."""
    # Without a display glfw would fail with an error of its own.
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
    # The first renderer is made while the window opens.
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

    # Files come by drag and drop, or by the desktop's own dialog.
    asking = Asking.where_there_is_one(session.drop)
    saver = Saver(session, Path.cwd(), copy, asking.ask if asking else None)
    view = CanvasView(canvas, session, saver)

    # As glfw calls it; its own type is that of the library behind it.
    def files_dropped(_: Any, names: list[str]) -> None:
        for name in names:
            session.drop(name)
        view.touched()

    dropped: Any = files_dropped
    glfw.set_drop_callback(canvas._window, dropped)
    # The loop draws, watches the scene file and the dialog, and ends by signals.
    if asking:
        loop.add_task(asking.watch, sleep, view, name="watch the dialog")
    loop.add_task(close_on_signals, canvas, name="close on signals")
    loop.add_task(view.watch, sleep, name="watch the scene file")
    loop.run()
    session.close()
