"""Lights in the image: a press takes the handle under it, and the light follows the hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.app.view.canvas import divider_marks
from airlight.app.view.gizmos import Grips, handles, place
from airlight.app.view.projection import Projection
from airlight.app.view.state import ViewState
from airlight.scene import AreaLight, DirectionalLight, PointLight, SpotLight
from airlight.scene.builtin.cornell import cornell
from airlight.scene.camera import Camera

SIZE = (400.0, 300.0)
CAMERA = Camera(position=(0.0, 1.0, 6.0), target=(0.0, 1.0, 0.0), fov_y_deg=50.0)
SEEN = Projection(CAMERA, SIZE)
LIGHTS = (
    PointLight(position=(-1.0, 1.5, 0.0), intensity=(1.0, 1.0, 1.0)),
    SpotLight(
        position=(1.2, 2.0, -1.0),
        direction=(0.0, -1.0, 0.0),
        intensity=(1.0, 1.0, 1.0),
    ),
    AreaLight(position=(0.2, 1.8, 0.5), radiance=(1.0, 1.0, 1.0), size=(0.6, 0.3)),
    DirectionalLight(direction=(0.1, -0.05, 1.0), irradiance=(1.0, 1.0, 1.0)),
)


def state(lights=LIGHTS) -> ViewState:
    return ViewState(replace(cornell(), lights=lights))


def drag(grips: Grips, begin, end) -> bool:
    def event(kind, at):
        return {"event_type": kind, "x": float(at[0]), "y": float(at[1]), "button": 1}

    took = grips.handle(event("pointer_down", begin), SEEN)
    grips.handle(event("pointer_move", end), SEEN)
    grips.handle(event("pointer_up", end), SEEN)
    return took


def test_points_and_pixels_go_both_ways():
    rng = np.random.default_rng(1)
    for point in rng.uniform(-1.0, 1.0, (20, 3)):
        x, y = SEEN.pixel(point)
        away = point - CAMERA.position
        assert np.allclose(SEEN.ray(x, y), away / np.linalg.norm(away))
        assert np.allclose(SEEN.on_plane(x, y, point, np.array([0.0, 0.0, 1.0])), point)
    assert np.allclose(SEEN.pixel(np.array([0.0, 1.0, 0.0])), (200.0, 150.0))
    assert SEEN.pixel(np.array([0.0, 1.0, 9.0])) is None
    # Up in the scene is up in the image; to the right is to the right.
    assert SEEN.pixel(np.array([0.5, 1.5, 0.0]))[0] > 200.0
    assert SEEN.pixel(np.array([0.5, 1.5, 0.0]))[1] < 150.0


@pytest.mark.parametrize("index", [0, 1, 2])
def test_a_light_follows_the_hand_in_the_plane_of_the_image(index):
    chosen = state()
    at = place(LIGHTS[index], SEEN)
    assert drag(Grips(chosen), np.add(at, (2.0, -1.0)), np.add(at, (42.0, 19.0)))
    assert (chosen.light, chosen.picked) == (index, index)
    moved = chosen.scene.lights[index]
    assert np.allclose(place(moved, SEEN), np.add(at, (40.0, 20.0)))
    assert moved.position[2] == pytest.approx(LIGHTS[index].position[2])  # the camera looks along z
    assert [a for i, a in enumerate(chosen.scene.lights) if i != index] == [
        a for i, a in enumerate(LIGHTS) if i != index
    ]


@pytest.mark.parametrize("axis", [0, 1])
def test_an_arrow_moves_along_its_axis_alone(axis):
    chosen = state()
    chosen.picked = 0
    arrow = next(h for h in handles(LIGHTS, 0, SEEN) if h.part == "axis" and h.axis == axis)
    assert drag(Grips(chosen), arrow.at, np.add(arrow.at, (30.0, -30.0)))
    by = np.subtract(chosen.scene.lights[0].position, LIGHTS[0].position)
    assert by[axis] > 0.1
    assert np.allclose(np.delete(by, axis), 0.0)


@pytest.mark.parametrize("index", [1, 2])
def test_the_dot_turns_a_light_to_where_the_hand_is(index):
    chosen = state()
    chosen.picked = index
    aim = next(h for h in handles(LIGHTS, index, SEEN) if h.part == "aim")
    at = place(LIGHTS[index], SEEN)
    assert drag(Grips(chosen), aim.at, np.add(at, (60.0, 0.0)))
    turned = chosen.scene.lights
    aim = next(h for h in handles(turned, index, SEEN) if h.part == "aim")
    assert np.allclose(aim.at, np.add(at, (60.0, 0.0)), atol=0.1)
    assert np.linalg.norm(turned[index].direction) == pytest.approx(1.0)
    assert chosen.scene.lights[index].position == LIGHTS[index].position


def test_the_sun_is_dragged_over_the_sky():
    chosen = state()
    at = place(LIGHTS[3], SEEN)
    assert drag(Grips(chosen), at, np.add(at, (25.0, -40.0)))
    assert np.allclose(place(chosen.scene.lights[3], SEEN), np.add(at, (25.0, -40.0)))


def test_beside_all_lights_the_press_is_the_cameras_and_hidden_marks_take_none():
    chosen = state()
    assert not drag(Grips(chosen), (5.0, 290.0), (50.0, 250.0))
    assert chosen.scene.lights == LIGHTS
    grips = Grips(chosen)
    grips.is_shown = False
    assert not drag(grips, place(LIGHTS[0], SEEN), (50.0, 250.0))
    assert grips.marks(SEEN) == ()


def test_only_the_picked_light_shows_handles_and_its_outline():
    chosen = state()
    grips = Grips(chosen)
    assert [mark.kind for mark in grips.marks(SEEN)] == ["dot"] * 4
    chosen.picked = 2
    marks = grips.marks(SEEN)
    outline = max(marks, key=lambda mark: len(mark.points))
    assert len(outline.points) == 5  # a rectangle, closed
    corner = np.add(LIGHTS[2].position, (0.3, 0.0, 0.15))
    nearest = min(np.hypot(*(np.array(p) - SEEN.pixel(corner))) for p in outline.points)
    assert nearest < 0.2


def test_the_line_between_two_images_is_dragged():
    chosen = state(())
    chosen.compared = "direct"
    assert drag(Grips(chosen), (203.0, 100.0), (100.0, 100.0))
    assert chosen.split == pytest.approx(0.25)


def test_the_line_is_where_the_hand_lets_go_whatever_moves_were_lost():
    chosen = state(())
    chosen.compared = "direct"
    grips = Grips(chosen)
    assert not grips.over_line(SEEN, 180.0)
    assert grips.over_line(SEEN, 196.0)
    press = {"event_type": "pointer_down", "x": 203.0, "y": 100.0, "button": 1}
    assert grips.handle(press, SEEN)
    assert grips.over_line(SEEN, 350.0)  # it is in the hand
    assert grips.handle({"event_type": "pointer_up", "x": 320.0, "y": 90.0, "button": 1}, SEEN)
    assert chosen.split == pytest.approx(0.8)
    assert not grips.is_held


def test_a_light_that_was_only_pressed_stays_what_it_is():
    chosen = state()
    at = place(LIGHTS[0], SEEN)
    assert drag(Grips(chosen), at, at)
    assert chosen.scene.lights[0] is LIGHTS[0]
    assert chosen.picked == 0


def test_both_images_beside_the_line_have_names():
    marks = list(divider_marks(0.25, "lpv", "direct", SEEN))
    dot, left, right = marks
    assert (dot.kind, dot.points) == ("dot", ((100.0, 150.0),))
    assert (left.text, left.ends_here) == ("lpv", True)
    assert (right.text, right.ends_here) == ("direct", False)
    assert left.points[0][0] < 100.0 < right.points[0][0]
