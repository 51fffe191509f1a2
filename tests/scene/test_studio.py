"""The studio's backdrop has no edge, belongs to its lights, and is metered as by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.colour import luminance
from airlight.maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from airlight.scene import Environment, PointLight, Scene
from airlight.scene.lights import DirectionalLight
from airlight.scene.studio import (
    GROUND_ALBEDO,
    NAME,
    PRINTED,
    incident_stops,
    studio,
    studio_light,
    studio_map,
)
from airlight.scene.sun_sky import followed

HEIGHT = 64
KEY = DirectionalLight((0.2, -0.8, -0.5), (20.0, 18.0, 15.0))
BESIDE = DirectionalLight((-0.9, -0.3, 0.1), (3.0, 6.0, 9.0))
FROM_BELOW = DirectionalLight((0.0, 1.0, 0.2), (50.0, 50.0, 50.0))


def unit(vector) -> np.ndarray:
    return np.asarray(vector) / np.linalg.norm(vector)


def irradiance(radiance: np.ndarray, normal) -> np.ndarray:
    """W m^-2 that a map sends onto a surface, texel by texel."""
    height, width = radiance.shape[:2]
    facing = np.maximum(latlong_texel_directions(height, width) @ unit(normal), 0.0)
    weights = facing * latlong_row_solid_angles(height, width)[:, None]
    return (weights[..., None] * radiance).sum(axis=(0, 1))


@pytest.mark.parametrize("lights", [(), (KEY,), (KEY, BESIDE), (KEY, FROM_BELOW)])
def test_a_matte_ground_under_it_is_as_bright_as_its_lower_half(lights):
    made = studio_map(lights, HEIGHT)
    received = irradiance(np.concatenate([made[: HEIGHT // 2], 0 * made[HEIGHT // 2 :]]), (0, 1, 0))
    for light in lights:
        received += np.array(light.irradiance) * max(-unit(light.direction)[1], 0.0)
    below = made[HEIGHT // 2 :].reshape(-1, 3)
    np.testing.assert_allclose(below, np.tile(GROUND_ALBEDO / np.pi * received, (len(below), 1)),
                               rtol=1e-5)  # fmt: skip


def test_at_the_horizon_it_goes_on_as_it_was():
    """Within a degree the cubic has left the backdrop by at most 3 (sin 1 / .25)^2 = 1.5 % of what
    hangs in the room, which glows three times as bright as the backdrop at most there."""
    made = studio_map((KEY,))
    row = len(made) // 2
    np.testing.assert_allclose(made[row - 1], made[row], rtol=0.015)
    elevations = np.degrees(np.arcsin(latlong_texel_directions(*made.shape[:2])[:, 0, 1]))
    near = made[np.abs(elevations) < 1.0]
    np.testing.assert_allclose(near, np.broadcast_to(made[row], near.shape), rtol=0.045)


def test_it_turns_with_its_lights():
    quarter = studio_map((replace(KEY, direction=(-0.5, -0.8, -0.2)),), HEIGHT)
    # A quarter about +Y takes (x, z) to (z, -x), and u = atan2(x, -z) / 2 pi back by a quarter.
    turned = np.roll(studio_map((KEY,), HEIGHT), -HEIGHT // 2, axis=1)
    np.testing.assert_allclose(quarter, turned, rtol=1e-5)


def test_lights_that_are_not_directional_are_none_of_its():
    assert studio((PointLight((0, 1, 0), (9, 9, 9)), KEY)).map is studio((KEY,)).map


@pytest.mark.parametrize("eye", [(0.0, 0.0, 1.0), (1.0, 0.4, 0.3), (-0.2, 0.8, 0.5)])
def test_a_sheet_between_eye_and_light_is_shown_by_its_albedo(eye):
    key, around = studio_light(unit((0.3, 0.7, 0.6)))
    sheet = unit(unit(eye) - unit(key.direction))
    received = irradiance(around.map.astype(float), sheet)
    received += np.array(key.irradiance) * float(sheet @ -unit(key.direction))
    shown = luminance(received) / np.pi * 2.0 ** incident_stops(key, around, np.array(eye))
    assert shown == pytest.approx(PRINTED, rel=0.005)  # stops have two decimals


def test_a_light_from_straight_behind_is_metered_as_it_is_met():
    key, around = studio_light(unit((0.0, 0.0, 1.0)))
    assert np.isfinite(incident_stops(key, around, np.array((0.0, 0.0, -1.0))))


def test_it_follows_its_light():
    scene = Scene(lights=(KEY,), environment=replace(studio((KEY,)), scale=0.5))
    assert followed(scene) is scene
    turned = followed(replace(scene, lights=(BESIDE,)))
    np.testing.assert_array_equal(turned.environment.map, studio_map((BESIDE,)))
    assert (turned.environment.source, turned.environment.scale) == (NAME, 0.5)
    other = replace(scene, environment=Environment(map=studio_map((KEY,))), lights=(BESIDE,))
    assert followed(other) is other
