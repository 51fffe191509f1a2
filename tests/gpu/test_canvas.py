"""Surfaces of canvases: the format of what is drawn, the size, a frame's target."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.canvas import CanvasSurface
from airlight.gpu.commands import Commands

pytestmark = pytest.mark.needs("rendercanvas")


@pytest.fixture
def canvas():
    from rendercanvas import offscreen

    made = offscreen.RenderCanvas(size=(40, 30), pixel_ratio=2.0)
    yield made
    made.close()


def test_a_surface_takes_encoded_images_as_they_are(gpu, canvas):
    surface = CanvasSurface(gpu, canvas)
    assert surface.format == "rgba8unorm"
    assert surface.size == (80, 60)


def test_what_is_drawn_is_what_the_canvas_shows(gpu, canvas):
    surface, commands = CanvasSurface(gpu, canvas), Commands(gpu)

    def draw() -> None:
        target = {
            "view": surface.view(),
            "load_op": "clear",
            "store_op": "store",
            "clear_value": (1.0, 0.5, 0.0, 1.0),
        }
        with commands.render("orange", color_attachments=[target]):
            pass
        commands.submit()

    canvas.request_draw(draw)
    shown = np.asarray(canvas.draw())
    assert shown.shape == (60, 80, 4)
    assert np.abs(shown[10, 10].astype(int) - [255, 128, 0, 255]).max() <= 1
