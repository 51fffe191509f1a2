"""A session and its panel on an offscreen canvas: who gets a click, and what keys do."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from airlight.app.view.canvas import CanvasView
from airlight.app.view.save import Saver
from airlight.app.view.session import Session
from airlight.errors import DeviceError
from airlight.gpu.device import open_gpu
from airlight.scene.io import load
from airlight.scene.volume import Volume
from small_viewer import SCENE
from small_viewer import SETTINGS as SMALL

PANEL_PX = 340

pytestmark = pytest.mark.needs("rendercanvas", "imgui_bundle")


@pytest.fixture(scope="module")
def view():
    from rendercanvas import offscreen

    try:
        open_gpu()
    except DeviceError as error:
        pytest.skip(str(error))
    canvas = offscreen.RenderCanvas(size=(480, 300))
    session = Session(load(SCENE), technique="single", settings=SMALL)
    made = CanvasView(canvas, session, Saver(session, Path()))
    yield made
    session.close()
    canvas.close()


def shown(view: CanvasView, frames: int = 4) -> np.ndarray:
    for _ in range(frames):
        image = view.canvas.draw()
        view.session.wait()
    return np.asarray(image)[..., :3].astype(int)


def event(view: CanvasView, kind: str, **fields: object) -> None:
    view.canvas.submit_event({"event_type": kind, "modifiers": (), "buttons": (), **fields})
    view.canvas._events.flush()


def drag(view: CanvasView, x: float, y: float, dx: float) -> None:
    event(view, "pointer_move", x=x, y=y)
    event(view, "pointer_down", x=x, y=y, button=1)
    event(view, "pointer_move", x=x + dx, y=y, buttons=(1,))
    event(view, "pointer_up", x=x + dx, y=y, button=1)


def test_the_first_frame_says_that_it_is_preparing(view):
    first = shown(view, 1)
    assert first[:, PANEL_PX:].max() == 0  # no image yet, only the panel
    assert first[:, :PANEL_PX].std() > 5.0
    assert shown(view)[:, PANEL_PX:].std() > 10.0


def test_a_drag_beside_the_panel_is_the_cameras_and_one_on_it_is_not(view):
    shown(view)
    before = view.session.controls.camera
    drag(view, 100.0, 200.0, 30.0)  # nothing drawn in between: imgui knows of no hover
    assert view.session.controls.camera == before
    drag(view, 400.0, 200.0, 30.0)
    assert view.session.controls.camera != before


def test_keys_of_the_viewer(view):
    shown(view)
    event(view, "key_down", key="Tab")
    assert not view.panel.is_shown
    bare = shown(view)
    drag(view, 100.0, 200.0, 30.0)  # where the panel was
    assert view.session.controls.camera != view.session.controls.home
    event(view, "key_down", key="r")
    assert view.session.controls.camera == view.session.controls.home
    event(view, "key_down", key="Tab")
    assert np.abs(shown(view)[:, :300] - bare[:, :300]).mean() > 10.0
    event(view, "key_down", key="f")
    assert view.session.controls.is_flying
    event(view, "key_down", key="f")


def test_every_section_of_the_panel_can_be_drawn(view):
    state = view.session.state
    local_lights = (*state.scene.lights,)
    volume = Volume((1.0, 2.0, 3.0), shape="sphere")
    before = state.scene
    state.scene = replace(before, volumes=(volume,), lights=local_lights)
    from airlight.app.view.state import fog_for

    state.scene = replace(state.scene, medium=fog_for(state.scene))
    state.message, state.notice, state.shows_times = "so much is wrong", "so much is well", True
    state.look = replace(state.look, exposure_stops=None)
    shown(view, 3)
    assert state.message == ""  # a renderer could be made
    assert view.session.times_ms
    state.scene, state.shows_times = before, False


def test_the_help_is_drawn_and_goes_again(view):
    before = shown(view)
    event(view, "char", data="?")
    helped = shown(view)
    assert np.abs(helped[:, PANEL_PX:] - before[:, PANEL_PX:]).mean() > 5.0
    event(view, "char", data="?")
    assert np.abs(shown(view)[:, PANEL_PX:] - before[:, PANEL_PX:]).mean() < 3.0


def test_the_sections_of_a_computed_sky_and_of_the_lens_can_be_drawn(view, monkeypatch):
    """Every section open: none of them refuses what a sky, thick fog and a lens give it."""
    from imgui_bundle import imgui

    from airlight.scene import Medium, Sky

    state, hands = view.session.state, view.session.controls
    before, camera = state.scene, hands.camera
    monkeypatch.setattr(imgui, "collapsing_header", lambda name, flags: True)
    state.put_sky(Sky(30.0, 200.0))
    assert state.look.exposure_stops is None
    state.scene = replace(state.scene, medium=Medium(sigma_t=50.0))
    assert len(view.session.doubts) == 1
    hands.camera = replace(camera, aperture_m=0.1)
    assert shown(view, 3).std() > 5.0
    assert state.message == ""
    assert state.scene.environment.sky == Sky(30.0, 200.0)  # no slider moved it by itself
    state.scene, hands.camera = before, camera


def test_a_canvas_of_nothing_is_not_drawn(view):
    view.canvas.set_physical_size(0, 0)
    view.draw()
    view.canvas.set_physical_size(30, 20)
    shown(view, 2)  # too small for a panel, not for an image
    assert not view.panel.covers(5.0, 5.0)
    view.canvas.set_physical_size(480, 300)
    assert shown(view).shape == (300, 480, 3)


def test_a_hand_at_work_is_noticed(view):
    event(view, "pointer_move", x=400.0, y=100.0)
    assert time.monotonic() - view.session._touched_s < 5.0


def test_the_pointer_shows_where_the_line_between_two_images_is_taken(view):
    view.panel.is_shown = False  # it lies over so narrow an image
    shown(view)
    place = view.image_place()
    line = place.corner[0] + 0.5 * place.extent[0]
    view.session.state.compared, view.session.state.split = "direct", 0.5
    event(view, "pointer_move", x=line + 40.0, y=150.0)
    assert view._cursor == "default"
    event(view, "pointer_move", x=line + 3.0, y=150.0)
    assert view._cursor == "ew-resize"
    view.session.state.compared = ""
    event(view, "pointer_move", x=line + 4.0, y=150.0)
    assert view._cursor == "default"
    view.panel.is_shown = True
