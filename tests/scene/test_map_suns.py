"""Suns in environment maps become directional lights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import airlight as al
from airlight.maths.latlong import (
    latlong_from_direction,
    latlong_row_solid_angles,
    latlong_texel_directions,
)
from airlight.scene.map_suns import SunlessEnvironment, SunLights, map_suns

SMALL = {"resolution": 8, "iterations": 8, "map_resolution": 32, "surfels": 10_000}
SMALL |= {"shadow_resolution": 1024, "sky_lights": 32, "sky_resolution": 32}
SKY = (0.4, 0.6, 1.0)
SUN = np.array((5.0, 4.0, 3.0))
TOWARDS = np.array((0.4, 0.7, -0.59))
TOWARDS /= np.linalg.norm(TOWARDS)


def photographed(*suns, height=256, radius_deg=0.6, irradiance=SUN):
    """A map of a uniform sky, with suns towards the directions given."""
    pixels = np.ones((height, 2 * height, 3)) * SKY
    solid = latlong_row_solid_angles(height, 2 * height)[:, None]
    directions = latlong_texel_directions(height, 2 * height)
    for towards in suns:
        u, v = latlong_from_direction(towards)
        nearest = np.zeros(pixels.shape[:2], bool)
        nearest[int(v * height), int(u * 2 * height) % (2 * height)] = True
        disc = nearest | (directions @ np.asarray(towards) > np.cos(np.radians(radius_deg)))
        pixels += disc[..., None] * irradiance / (solid * disc).sum()
    return pixels.astype(np.float32)


def flux(pixels):
    return (pixels * latlong_row_solid_angles(*pixels.shape[:2])[:, None, None]).sum(axis=(0, 1))


@pytest.mark.parametrize(
    "towards",
    [
        TOWARDS,
        (0.0, 0.0, -1.0),  # where the columns begin
        np.array((0.003, 1.0, 0.003)) / np.linalg.norm((0.003, 1.0, 0.003)),  # over the pole
    ],
)
def test_a_sun_is_found_with_all_of_its_light(towards):
    pixels = photographed(towards)
    found = map_suns(pixels)
    assert found is not None and len(found.towards) == 1
    # within half a texel
    assert np.degrees(np.arccos(min(found.towards[0] @ np.asarray(towards), 1.0))) < 0.36
    np.testing.assert_allclose(found.irradiance[0], SUN, rtol=1e-3)
    np.testing.assert_allclose(found.rest, np.ones(found.rest.shape) * SKY, rtol=1e-5)
    np.testing.assert_allclose(flux(found.rest) + found.irradiance[0], flux(pixels), rtol=1e-4)
    # What is seen is the file's own: the colour of its sun times its luminance, on the rest.
    seen = found.rest + found.luminance[..., None] * np.array(found.colour, np.float32)
    np.testing.assert_allclose(seen, pixels, rtol=2e-3, atol=2e-3 * float(SUN.max()))


def test_suns_are_told_from_wide_and_weak_light():
    assert map_suns(photographed()) is None
    assert map_suns(photographed(TOWARDS, radius_deg=5.0)) is None
    assert map_suns(photographed(TOWARDS, irradiance=SUN * 0.02)) is None
    # Texels of coarse maps are no suns, however bright.
    assert map_suns(photographed(TOWARDS, height=64)) is None
    assert map_suns(np.zeros((256, 512, 3), np.float32)) is None


def test_there_may_be_several():
    places = np.eye(3)
    found = map_suns(photographed(*places))
    assert found is not None and len(found.towards) == 3
    assert np.abs(found.towards @ places.T).max(axis=1) == pytest.approx(1.0, abs=1e-4)
    assert len(map_suns(photographed(*places), 2).towards) == 2


def test_lights_follow_the_environment_and_keep_their_number():
    lights = SunLights()
    environment = al.Environment(map=photographed(TOWARDS), rotation_deg=30.0, scale=2.0)
    scene = al.Scene(environment=environment)
    shown = lights.of(scene)
    (sun,) = shown.lights
    assert isinstance(shown.environment, SunlessEnvironment)
    np.testing.assert_allclose(sun.irradiance, 2.0 * SUN, rtol=1e-3)
    # Counter-clockwise from above: the azimuth from +z over +x grows.
    azimuth = np.degrees(np.arctan2(TOWARDS[0], TOWARDS[2]))
    turned = np.degrees(np.arctan2(-sun.direction[0], -sun.direction[2]))
    assert (turned - azimuth) % 360.0 == pytest.approx(30.0, abs=0.5)
    assert lights.of(scene).environment is shown.environment
    # Without a sun there is a black one, of two suns the second stays in the map.
    other = lights.of(replace(scene, environment=al.Environment()))
    assert [light.irradiance for light in other.lights] == [(0.0, 0.0, 0.0)]
    two = replace(environment, map=photographed(*np.eye(3)[:2]))
    assert len(lights.of(replace(scene, environment=two)).lights) == 1


@pytest.mark.parametrize("samples", [1, 4])
def test_a_sun_in_a_map_is_as_one_that_is_a_light(square, samples):
    """On a floor below a board: the shadow, its edge and the light around it."""
    camera = al.Camera((0.0, 3.0, 4.0), (0.0, 0.0, 0.0), fov_y_deg=40.0)
    board = square((0.0, 1.0, 0.0), (0.5, 0.0, 0.0), (0.0, 0.0, 0.5))
    floor = square((0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 0.0, 4.0))
    scene = al.Scene(meshes=(board, floor), camera=camera)
    d = tuple((-TOWARDS).tolist())
    lit = replace(
        scene,
        environment=al.Environment(map=photographed()),
        lights=(al.DirectionalLight(d, tuple(SUN.tolist())),),
    )
    photo = replace(scene, environment=al.Environment(map=photographed(TOWARDS)))
    images = [
        al.render(s, technique="lpv", size=(48, 32), samples=samples, settings=SMALL).layers[
            "direct"
        ]
        for s in (lit, photo)
    ]
    # The direction of a map's sun is that of texels, .7 degrees apart: edges move by .02 m.
    apart = np.abs(images[1] - images[0]).max(axis=2) > 0.02 * images[0].max()
    assert apart.mean() < 0.03
    assert images[1].sum() == pytest.approx(images[0].sum(), rel=0.01)
