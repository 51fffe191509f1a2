"""The viewer in a notebook: a live widget, and a still image where widgets do not run."""

from __future__ import annotations

import asyncio
import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...scene.image import Image
from ...scene.io import load
from ...scene.scene import Scene
from .canvas import CanvasView
from .messages import believed
from .page import Page, web_text
from .session import Session

_STILL_SAMPLES = 8


def view(
    scene: Scene | str | Path,
    technique: str = "auto",
    size: tuple[int, int] = (800, 450),
    *,
    settings: Mapping[str, Any] | None = None,
    adapter: str = "auto",
) -> Any:
    """Look at `scene` in a notebook: the live widget, to be the last value of a cell.

    A path or builtin:NAME is loaded, and read again when the file is saved. Where an event loop
    runs, as in a notebook's kernel, the call returns as soon as the scene is loaded: the widget
    draws on that loop, its panel says how far it is and what went wrong, and `snapshot()` puts a
    still image into the notebook for pages without a kernel. Without a loop the call waits for a
    still image, which stands behind the widget; without anywidget it is all there is. Outside
    notebooks use `airlight view`. Raises SceneError, SettingsError, DeviceError.
    """
    # A scene that came as a value has no file to watch.
    source = "" if isinstance(scene, Scene) else str(scene)
    loaded = scene if isinstance(scene, Scene) else load(source)
    session = Session(
        loaded, source=source, technique=technique, settings=settings, adapter=adapter
    )
    session.prepare(size)
    # Without widgets a still image is all that a notebook can show.
    try:
        from rendercanvas import anywidget
    except ImportError:
        still = session.image(_STILL_SAMPLES)
        session.close()
        return still
    return live_widget(
        anywidget, session, size, None if loop_runs() else session.image(_STILL_SAMPLES)
    )


def loop_runs() -> bool:
    """Whether this thread is in an event loop, which draws when the call has returned."""
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return False
    return True


def live_widget(
    anywidget: Any, session: Session, size: tuple[int, int], still: Image | None
) -> Any:
    """A canvas of `rendercanvas.anywidget` with `session` on it and `still`, if any, behind it."""

    # Messages from the page: the panel's own first, then those of events, as far as they are
    # believed.
    class LiveView(anywidget.AnywidgetRenderCanvas):  # type: ignore[misc]
        _esm, _css = widget_files(anywidget.JS, anywidget.CSS)

        def _rfb_handle_msg(self, widget: Any, content: Any, buffers: Any) -> None:
            if page.heard(content):
                return
            kept = content if content == {"type": "close"} else believed(content)
            if kept is not None:
                super()._rfb_handle_msg(widget, kept, buffers)

        def _repr_mimebundle_(self, **kwargs: Any) -> Any:
            # The still stands in the notebook's file, for pages without a kernel.
            bundle = super()._repr_mimebundle_(**kwargs)
            data, metadata = bundle if isinstance(bundle, tuple) else (bundle or {}, {})
            if still is None:
                return data, metadata
            image = base64.b64encode(still._repr_png_()).decode()
            return {**data, "image/png": image}, metadata

    # The canvas draws, the page shows the panel, and the file is watched on the widget's loop.
    page = Page(session, lambda message: canvas.send(message))
    canvas = LiveView(size=size, max_fps=30, update_mode="ondemand")
    canvas.view = CanvasView(canvas, session, page.saver, page)
    page.touched = canvas.view.touched
    from rendercanvas.utils.asyncs import sleep

    anywidget.loop.add_task(canvas.view.watch, sleep, name="watch the scene file")
    return canvas


def widget_files(js: str, css: str) -> tuple[str, str]:
    """The module and the style of the widget: rendercanvas's, with the panel beside its image."""
    module = js.replace("export default", "const renderviewModule =", 1)
    return (
        "\n".join([module, web_text("panel.js"), web_text("notebook.js")]),
        f"{css}\n{web_text('panel.css')}",
    )
