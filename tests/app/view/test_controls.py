"""Events in, cameras out: directions that a hand expects, and no way to lose the camera."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.view.controls import LEFT, RIGHT, CameraControls, turned_direction
from airlight.scene.camera import Camera, axes


@pytest.fixture
def controls() -> CameraControls:
    made = CameraControls(Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0)), reach_m=10.0)
    made.height_px = 200.0
    return made


def drag(controls, dx, dy, button=LEFT, modifiers=()):
    at = {"x": 50.0, "y": 60.0, "button": button, "modifiers": modifiers}
    controls.handle({"event_type": "pointer_down", **at})
    controls.handle({"event_type": "pointer_move", **at, "x": 50.0 + dx, "y": 60.0 + dy})
    controls.handle({"event_type": "pointer_up", **at})


def test_a_drag_to_the_right_orbits_to_the_left_of_the_target(controls):
    # The scene follows the hand: what is in front moves right, so the eye goes left.
    drag(controls, 100.0, 0.0)  # half the height: a quarter turn
    assert np.allclose(controls.camera.position, (-5.0, 0.0, 0.0), atol=1e-9)
    assert controls.camera.target == (0.0, 0.0, 0.0)


def test_a_drag_downwards_raises_the_eye(controls):
    drag(controls, 0.0, 50.0)
    assert controls.camera.position[1] == pytest.approx(5.0 * np.sin(np.pi / 4))
    assert np.linalg.norm(controls.camera.position) == pytest.approx(5.0)


def test_no_drag_goes_over_the_pole(controls):
    drag(controls, 0.0, 1e6)
    look = np.subtract(controls.camera.target, controls.camera.position) / 5.0
    assert look[1] == pytest.approx(-np.sin(np.radians(89.0)))
    drag(controls, 30.0, -3.0)  # and it can leave again
    assert np.all(np.isfinite(controls.camera.position))


def test_flying_turns_the_head_and_keeps_the_feet(controls):
    controls.is_flying = True
    drag(controls, 100.0, 0.0)
    assert controls.camera.position == (0.0, 0.0, 5.0)
    assert np.allclose(controls.camera.target, (5.0, 0.0, 5.0), atol=1e-9)


@pytest.mark.parametrize("how", [{"button": RIGHT}, {"modifiers": ("Shift",)}])
def test_panning_moves_what_is_under_the_hand_with_it(controls, how):
    drag(controls, 0.0, 200.0, **how)  # by the height of the image
    span = 2.0 * 5.0 * np.tan(np.radians(25.0))
    assert np.allclose(controls.camera.target, (0.0, span, 0.0))
    assert np.allclose(controls.camera.position, (0.0, span, 5.0))


def test_the_wheel_comes_nearer_and_never_arrives(controls):
    controls.handle({"event_type": "wheel", "dy": -100.0})
    assert controls.camera.position[2] == pytest.approx(5.0 * 0.88)
    for _ in range(50):
        controls.handle({"event_type": "wheel", "dy": -2000.0})
    assert controls.camera.position[2] >= 1e-3
    controls.handle({"event_type": "wheel", "dy": 300.0})
    assert controls.camera.position[2] > 1e-3


def test_keys_fly_while_they_are_held(controls):
    controls.handle({"event_type": "key_down", "key": "w"})
    assert controls.is_moving
    controls.advance(0.1)
    step = 5.0 - controls.camera.position[2]
    assert step == pytest.approx(0.12 * 10.0 * 0.1)
    controls.handle({"event_type": "key_down", "key": "Shift"})
    controls.advance(0.1)
    assert 5.0 - controls.camera.position[2] == pytest.approx(5.0 * step)
    controls.handle({"event_type": "key_up", "key": "W"})  # shift makes it a capital
    assert not controls.is_moving
    controls.advance(0.1)
    assert 5.0 - controls.camera.position[2] == pytest.approx(5.0 * step)


def test_a_frame_that_took_long_flies_no_further_than_a_quarter_second(controls):
    controls.handle({"event_type": "key_down", "key": "d"})
    controls.advance(60.0)
    assert controls.camera.position[0] == pytest.approx(0.12 * 10.0 * 0.25)


def test_a_lost_window_lets_go(controls):
    controls.handle({"event_type": "key_down", "key": "w"})
    controls.handle({"event_type": "pointer_down", "x": 0, "y": 0, "button": LEFT})
    controls.release()
    assert not controls.is_held
    before = controls.camera
    controls.handle({"event_type": "pointer_move", "x": 90, "y": 9})
    assert controls.camera is before


def test_the_sun_is_turned_with_control_or_l(controls):
    before = controls.camera
    drag(controls, 100.0, -50.0, modifiers=("Control",))
    assert controls.camera is before
    turn = controls.take_turn()
    assert (turn.azimuth_deg, turn.elevation_deg) == pytest.approx((90.0, 45.0))
    assert controls.take_turn().azimuth_deg == 0.0
    controls.handle({"event_type": "key_down", "key": "l"})
    drag(controls, 20.0, 0.0)
    assert controls.take_turn().azimuth_deg == pytest.approx(18.0)


def test_reset_returns_to_the_scenes_camera(controls):
    drag(controls, 31.0, 7.0)
    controls.reset()
    assert controls.camera == Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0))


def test_unknown_events_do_nothing(controls):
    controls.handle({"event_type": "before_draw"})
    controls.handle({"event_type": "wheel"})
    assert controls.camera == controls.home


def test_axes_are_right_handed():
    right, up, forward = axes(Camera((1.0, 2.0, 3.0), (4.0, 1.0, -2.0)))
    assert np.allclose(np.cross(right, up), -forward)
    assert up[1] > 0.0


def test_a_vertical_direction_can_be_turned():
    turned = turned_direction((0.0, -1.0, 0.0), (0.0, 1.0, 0.0), 30.0, 40.0)
    assert np.linalg.norm(turned) == pytest.approx(1.0)
    assert turned[1] == pytest.approx(-np.sin(np.radians(50.0)), abs=1e-6)
