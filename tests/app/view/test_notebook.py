"""`al.view` in a notebook: a widget, a still behind it, and a still alone without widgets."""

from __future__ import annotations

import asyncio
import base64
import io
import sys
import types
from typing import ClassVar

import numpy as np
import pytest

import airlight as al
from airlight.errors import SceneError
from small_viewer import SETTINGS as SMALL

SIZE = (64, 36)
pytestmark = pytest.mark.usefixtures("gpu")


def pixels(png: bytes) -> np.ndarray:
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def test_without_a_widget_there_is_a_still(monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "rendercanvas.anywidget", raising=False)
    shown = al.view("builtin:cornell", "direct", SIZE, settings=SMALL)
    assert pixels(shown._repr_png_()).shape == (SIZE[1], SIZE[0], 3)
    assert pixels(shown._repr_png_()).std() > 5.0


def test_a_missing_scene_is_said():
    with pytest.raises(SceneError, match="cornel"):
        al.view("builtin:cornel")


@pytest.fixture
def fake_widgets(monkeypatch):
    """In the place of `rendercanvas.anywidget`: a canvas that a running event loop draws."""
    from rendercanvas import offscreen

    class Canvas(offscreen.OffscreenRenderCanvas):
        image = None
        is_asked = False

        def send(self, message, buffers=None):
            self.said = message

        def request_draw(self, *args):
            super().request_draw(*args)
            if not self.is_asked and not self.get_closed():
                self.is_asked = True
                asyncio.get_running_loop().call_later(0.01, self.shown)

        def shown(self):
            self.is_asked = False
            self.image = np.asarray(self.draw())[..., :3].astype(int)

        def _repr_mimebundle_(self, **kwargs):
            return {"text/plain": "a widget"}, {}

    class Loop:
        tasks: ClassVar[list] = []

        def add_task(self, function, *args, name):
            self.tasks.append(asyncio.get_running_loop().create_task(function(*args), name=name))

    module = types.ModuleType("rendercanvas.anywidget")
    module.AnywidgetRenderCanvas, module.loop = Canvas, Loop()
    module.JS, module.CSS = "export default {}", ""
    monkeypatch.setitem(sys.modules, "rendercanvas.anywidget", module)
    monkeypatch.setattr("rendercanvas.anywidget", module, raising=False)
    return module


@pytest.mark.needs("rendercanvas")
def test_in_a_running_loop_the_call_returns_and_the_loop_draws(fake_widgets):
    """What blocks its cell has a renderer, and an image, before the loop has its turn."""

    async def cell():
        widget = al.view("builtin:cornell", "direct", SIZE, settings=SMALL)
        session = widget.view.session
        at_once = session.renderer, widget.image, widget._repr_mimebundle_()
        turns = 0
        while session.renderer is None or widget.image is None or widget.image.std() < 5.0:
            turns += 1
            assert turns < 4000 and not session.state.message, session.state.message
            await asyncio.sleep(0.02)
        widget.close()
        await asyncio.gather(*fake_widgets.loop.tasks)
        session.close()
        return at_once, turns, widget.image

    (renderer, first, (bundle, _)), turns, image = asyncio.run(cell())
    assert renderer is None and first is None
    assert "image/png" not in bundle
    assert turns > 1
    assert image.shape == (SIZE[1], SIZE[0], 3)


NOTEBOOK = """
import airlight as al
widget = al.view("builtin:cornell", "direct", (64, 36), settings=dict(resolution=8,
    shadow_resolution=64, sky_lights=0, surfels=2000, ambient_occlusion=False))
sent, told = [], []
widget.send = lambda message, buffers=None: (
    sent.append((message, buffers)) if buffers else told.append(message))
widget
"""
FRONT_END = """
import asyncio

def say(type, **fields):
    widget._rfb_handle_msg(widget, {"type": type, "timestamp": 0.0, **fields}, [])

async def images(count):
    # What renderview-afm.js does in a page: it shows itself, then confirms every image.
    widget._has_visible_views = True
    for _ in range(600):
        if sent:
            widget._frame_feedback = {
                "index": sent[-1][0]["index"], "timestamp": 0.0, "localtime": 0.0}
        if len(sent) >= count:
            return sent[-1][1][0]
        widget.request_draw()
        await asyncio.sleep(0.05)
    raise TimeoutError("no images")

say("hello", shown=True)
say("resize", width=720, height=200, pwidth=720, pheight=200, ratio=1.0)
session = widget.view.session
while session.renderer is None or session.state.notice:
    await images(len(sent) + 1)
before = await images(len(sent) + 6)
at = dict(x=400.0, y=90.0, buttons=[1], modifiers=[], ntouches=0, touches={})
say("pointer_down", **at, button=1)
say("pointer_move", **{**at, "x": 460.0}, button=0)
say("pointer_up", **{**at, "x": 460.0}, button=1)
after = await images(len(sent) + 8)
assert {"panel", "status", "marks"} <= {message["type"] for message in told}
import base64
print(base64.b64encode(before).decode())
print(base64.b64encode(after).decode())
"""


STILL = """
shown_already = len(sent)
widget.snapshot()
await images(shown_already + 2)
"""


@pytest.mark.slow
@pytest.mark.needs("nbformat", "nbclient", "ipykernel", "anywidget")
def test_the_notebook_runs_and_a_drag_changes_the_widget(tmp_path):
    import nbclient
    import nbformat

    cells = [nbformat.v4.new_code_cell(text.strip()) for text in (NOTEBOOK, FRONT_END, STILL)]
    notebook = nbformat.v4.new_notebook(cells=cells)
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3"}
    nbclient.NotebookClient(
        notebook, timeout=240, resources={"metadata": {"path": tmp_path}}
    ).execute()
    shown = next(o for o in cells[0].outputs if o.output_type == "execute_result").data
    assert "application/vnd.jupyter.widget-view+json" in shown
    assert "image/png" not in shown  # the cell did not wait for one
    replaced = [o for o in cells[2].outputs if "text/html" in o.get("data", {})]
    assert any("data:image/" in o.data["text/html"] for o in replaced)
    streams = [o for o in cells[1].outputs if o.output_type == "stream" and o.name == "stdout"]
    text = "".join(o.text for o in streams).split()
    before, after = (pixels(base64.b64decode(part)) for part in text)
    assert before.shape == after.shape == (200, 720, 3)
    assert np.abs(after - before).mean() > 2.0
