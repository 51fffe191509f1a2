"""Lights that are turned, scenes that are merged with their files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.app.view.controls import Turn
from airlight.app.view.state import (
    ViewState,
    fog_for,
    reloaded,
    same,
    source_angles_deg,
    structure,
    travel_from,
)
from airlight.scene import (
    AreaLight,
    Camera,
    DirectionalLight,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
)
from airlight.scene.shapes import box
from airlight.scene.studio import studio

SUN = DirectionalLight((0.0, -1.0, -1.0), (1.0, 1.0, 1.0))


def scene(*lights, **parts) -> Scene:
    return Scene(meshes=(Mesh(box()),), lights=lights, **parts)


def test_the_sun_has_the_angles_it_is_put_at():
    assert source_angles_deg(SUN.direction) == pytest.approx((0.0, 45.0))
    for azimuth, elevation in ((90.0, 30.0), (-135.0, 5.0), (20.0, -3.0)):
        angles = source_angles_deg(travel_from(azimuth, elevation))
        assert angles == pytest.approx((azimuth, elevation))
    assert travel_from(90.0, 0.0) == pytest.approx((-1.0, 0.0, 0.0), abs=1e-12)


def test_turning_turns_where_the_light_comes_from():
    state = ViewState(scene(SUN))
    state.turn_light(Turn(30.0, 10.0))
    assert source_angles_deg(state.scene.lights[0].direction) == pytest.approx((30.0, 55.0))


def test_spots_turn_and_lights_go_around():
    spot = SpotLight((1.0, 2.0, 0.0), (0.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    local_light = PointLight((1.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    state = ViewState(scene(SUN, spot, local_light), light=1)
    state.turn_light(Turn(90.0, 0.0))
    turned = state.scene.lights[1]
    assert turned.position == spot.position
    assert turned.direction == pytest.approx((-np.sqrt(0.5), -np.sqrt(0.5), 0.0))
    state.light = 2
    state.turn_light(Turn(90.0, 0.0))
    assert state.scene.lights[2].position == pytest.approx((0.0, 0.0, -1.0), abs=1e-9)
    assert state.scene.lights[0] is SUN


def test_a_ball_of_light_has_no_aim_and_goes_around():
    """Its `direction` is that of flat shapes, which nobody would see turn."""
    ball = AreaLight((1.0, 0.0, 0.0), (1.0, 1.0, 1.0), shape="sphere", radius=0.1)
    state = ViewState(scene(ball))
    state.turn_light(Turn(90.0, 0.0))
    assert state.scene.lights[0].position == pytest.approx((0.0, 0.0, -1.0), abs=1e-9)
    assert state.scene.lights[0].direction == ball.direction


def test_a_studio_follows_its_light_in_the_same_renderer():
    state = ViewState(scene(SUN, environment=studio((SUN,))))
    before = structure(state)
    state.turn_light(Turn(60.0, 20.0))
    state.settle_sky()
    expected = studio(state.scene.lights).map
    np.testing.assert_array_equal(state.scene.environment.map, expected)
    assert not np.array_equal(expected, studio((SUN,)).map)
    assert structure(state) == before


def test_no_light_and_no_turn_are_no_matter():
    state = ViewState(scene())
    before = state.scene
    state.turn_light(Turn(5.0, 0.0))
    assert state.scene is before


def test_what_needs_another_renderer():
    state = ViewState(scene(SUN))
    before = structure(state)
    state.turn_light(Turn(5.0, 0.0))
    state.scene = replace(state.scene, camera=Camera((9.0, 9.0, 9.0)))
    assert structure(state) == before
    for change in (
        {"medium": Medium((0.1, 0.1, 0.1))},
        {"lights": (SUN, SUN)},
        {"meshes": (Mesh(box()),)},
    ):
        assert structure(ViewState(replace(state.scene, **change))) != before
    state.settings["auto"] = {"resolution": 8}
    assert structure(state) != before


def test_a_reload_takes_what_the_file_changed_and_keeps_the_rest():
    before = scene(SUN, medium=Medium((0.1, 0.1, 0.1)))
    now = replace(before, lights=(replace(SUN, direction=travel_from(80.0, 20.0)),))
    after = scene(SUN, medium=Medium((0.3, 0.1, 0.1)))  # new arrays of the same values
    merged = reloaded(now, before, after)
    assert merged.lights is now.lights
    assert merged.meshes is now.meshes
    assert merged.medium is after.medium
    assert reloaded(now, before, scene(SUN, medium=before.medium)) is now


def test_same_compares_values_and_shapes():
    assert same(Mesh(box()), Mesh(box()))
    assert not same(np.zeros(3), np.zeros(4))
    assert not same({"a": 1}, {"b": 1})
    assert not same((1, 2), (1, 3))
    assert not same(1, 1.5)


def test_the_fog_that_is_added_is_thin():
    low, high = scene(SUN).bounds
    across = float(np.linalg.norm(high - low))
    assert np.exp(-fog_for(scene(SUN)).sigma_t[0] * across) == pytest.approx(0.905, abs=1e-3)
