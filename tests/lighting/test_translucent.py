"""Surfaces that light passes, in images: against what each pixel's ray meets, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.translucency import dielectric_fresnel, passed_share
from airlight.scene import (
    Camera,
    DirectionalLight,
    Material,
    Medium,
    PointLight,
    Scene,
    Texture,
)

WALL = np.array([2.0, 1.0, 0.5])
AHEAD = Camera(position=(0, 0, 5), target=(0, 0, 0), fov_y_deg=30)
pytestmark = pytest.mark.both_paths


def glowing(radiance, **more):
    """A surface that glows and reflects nothing."""
    return Material(base_color=(0, 0, 0), specular=0.0, emission=tuple(radiance), **more)


def panes_before_a_wall(square, count):
    """A glowing wall at z = 0, and before it panes from z = 1 on, each with its own look."""
    looks = [
        glowing(np.roll((0.6, 0.1, 0.3), k), alpha=0.3 + 0.1 * k, is_blended=True)
        for k in range(count)
    ]
    panes = [
        square((0, 0, 1.0 + 0.4 * k), (9, 0, 0), (0, 9, 0), look) for k, look in enumerate(looks)
    ]
    return looks, panes, square((0, 0, 0), (9, 0, 0), (0, 9, 0), glowing(WALL))


def through(looks, behind):
    """Radiance through panes, the farthest first."""
    for look in looks:
        behind = look.alpha * np.array(look.emission) + (1.0 - look.alpha) * behind
    return behind


@pytest.mark.parametrize("count", [1, 2, 4])
def test_panes_are_blended_in_their_order(rendered, square, count):
    looks, panes, wall = panes_before_a_wall(square, count)
    image = rendered(Scene(meshes=(panes[0], wall, *panes[:0:-1]), camera=AHEAD))
    # Half floats hold coverage and what passes: 2^-11 a layer.
    expected = np.broadcast_to(through(looks, WALL), image.radiance.shape)
    np.testing.assert_allclose(image.radiance, expected, rtol=count * 2.0**-10)
    assert image.layers["depth"][24, 32] == pytest.approx(5.0, rel=1e-4)  # that of the wall


def test_as_many_layers_as_are_asked_for(rendered, square):
    looks, panes, wall = panes_before_a_wall(square, 4)
    image = rendered(Scene(meshes=(wall, *panes), camera=AHEAD), translucent_layers=2)
    expected = np.broadcast_to(through(looks[2:], WALL), image.radiance.shape)
    np.testing.assert_allclose(image.radiance, expected, rtol=2e-3)
    image = rendered(Scene(meshes=(wall, *panes), camera=AHEAD), translucent_layers=0)
    np.testing.assert_allclose(image.radiance, np.broadcast_to(WALL, image.radiance.shape), 1e-3)


def test_a_pane_behind_a_wall_is_not_seen(rendered, square):
    _, panes, wall = panes_before_a_wall(square, 1)
    behind = replace(panes[0], world_from_object=np.diag([1.0, 1.0, -1.0, 1.0]))
    image = rendered(Scene(meshes=(wall, behind), camera=AHEAD))
    np.testing.assert_allclose(image.radiance, np.broadcast_to(WALL, image.radiance.shape), 1e-3)


def test_alpha_of_a_map_is_coverage(rendered, square):
    pixels = np.zeros((1, 256, 4), np.uint8)
    pixels[0, :, 3] = np.arange(256)
    look = glowing(
        (1, 1, 1), base_color_texture=Texture(pixels, wrap=("clamp",) * 2), is_blended=True
    )
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    pane = square((0, 0, 1), (2, 0, 0), (0, 2, 0), look, uvs=uvs)
    wall = square((0, 0, 0), (9, 0, 0), (0, 9, 0), glowing((0, 0, 0)))
    row = rendered(Scene(meshes=(wall, pane), camera=AHEAD)).radiance[24, :, 0]
    half = np.tan(np.radians(15.0)) * 64 / 48 * 4.0
    x = ((np.arange(64) + 0.5) / 64 * 2.0 - 1.0) * half
    # Bytes of alpha, half floats, and filtering between mip levels.
    np.testing.assert_allclose(row, (x + 2.0) / 4.0, atol=0.004)


@pytest.mark.parametrize("angle_deg", [0.0, 50.0, 65.0])
def test_glass_is_tinted_and_mirrors_by_the_angle(rendered, square, angle_deg):
    tint, share = np.array((0.9, 0.5, 0.2)), 0.8
    look = Material(base_color=tuple(tint), transmission=share, roughness=0.3)
    turn = np.radians(angle_deg)
    pane = square((0, 0, 2), (9 * np.cos(turn), 0, -9 * np.sin(turn)), (0, 9, 0), look)
    wall = square((0, 0, -20), (1, 0, 0), (0, 1, 0), glowing(WALL))  # lights its back alone
    camera = replace(AHEAD, fov_y_deg=1.0)
    image = rendered(Scene(meshes=(wall, pane), camera=camera))
    mirrored = dielectric_fresnel([0.04], [np.cos(turn)])
    expected = WALL * passed_share(tint[None], [1.0], [share], mirrored)[0]
    np.testing.assert_allclose(image.radiance[24, 32], expected, rtol=4e-3)


LIGHTS = [
    DirectionalLight((0.5, -1, 0), (3, 3, 3)),
    PointLight((-1, 2, 0), (30, 30, 30)),
]


@pytest.mark.parametrize("light", LIGHTS)
def test_light_comes_through_tinted(rendered, seen_points, square, light):
    """Below a pane of glass the floor is as bright as without it, times what passes."""
    floor = square((0, 0, 0), (6, 0, 0), (0, 0, -6), Material(base_color=(0.6,) * 3, specular=0))
    tint = np.array((0.9, 0.4, 0.1))
    look = Material(base_color=tuple(tint), transmission=1.0)
    pane = square((0, 1, 0), (0.8, 0, 0), (0, 0, -0.8), look)
    camera = Camera(position=(0.5, 8, 0.01), target=(0.5, 0, 0), fov_y_deg=30)
    bare = Scene(meshes=(floor,), lights=(light,), camera=camera)
    without = rendered(bare, shadow_resolution=1024)
    # Seen from above the pane itself hides its shadow: no layer is drawn.
    lit = rendered(
        replace(bare, meshes=(floor, pane)), translucent_layers=0, shadow_resolution=1024
    )
    points = seen_points(without, camera).reshape(-1, 3)
    if isinstance(light, PointLight):
        to_light = np.array(light.position) - points
    else:
        to_light = -np.array(light.direction)
    to_light = to_light / np.linalg.norm(to_light, axis=-1, keepdims=True) + 0.0 * points
    met = points + to_light / to_light[:, 1:2]
    inside = 0.8 - np.abs(met[:, [0, 2]]).max(axis=1)
    mirrored = dielectric_fresnel(0.04, to_light[:, 1])
    count = len(points)
    passed = passed_share(np.tile(tint, (count, 1)), np.ones(count), np.ones(count), mirrored)
    ratio = (lit.radiance / without.radiance).reshape(-1, 3)
    is_in, is_out = inside > 0.05, inside < -0.05
    assert is_in.sum() > 100 and is_out.sum() > 500
    # Maps are asked two or three texels beside the point, which of a lamp's 256 are 1.5 degrees.
    np.testing.assert_allclose(ratio[is_in], passed[is_in], rtol=8e-3)
    np.testing.assert_allclose(ratio[is_out], 1.0, rtol=1e-5)


@pytest.mark.parametrize("technique", ["single", "lpv-scatter"])
def test_media_before_and_behind_a_pane(rendered, square, technique):
    """An absorbing medium dims the pane by the path to it, the wall by all of it."""
    looks, panes, wall = panes_before_a_wall(square, 2)
    medium = Medium(sigma_t=(0.3, 0.2, 0.1), albedo=(0, 0, 0), bounds=((-9, -9, -1), (9, 9, 6)))
    camera = replace(AHEAD, fov_y_deg=1.0)
    scene = Scene(meshes=(wall, *panes), camera=camera, medium=medium)
    image = rendered(scene, technique)
    attenuated = [
        replace(
            look, emission=tuple(np.array(look.emission) * np.exp(-np.array(medium.sigma_t) * d))
        )
        for look, d in zip(looks, (4.0, 3.6), strict=True)
    ]
    expected = through(attenuated, WALL * np.exp(-np.array(medium.sigma_t) * 5.0))
    np.testing.assert_allclose(image.radiance[24, 32], expected, rtol=4e-3)


def test_fog_is_not_counted_twice(rendered, square):
    """A pane that is hardly there changes nothing of the light that media scatter."""
    fog = Medium(sigma_t=(0.2,) * 3, bounds=((-9, -9, -1), (9, 9, 6)))
    wall = square((0, 0, 0), (9, 0, 0), (0, 9, 0), Material(base_color=(0.5,) * 3, specular=0))
    faint = Material(base_color=(0, 0, 0), specular=0, alpha=1e-3, is_blended=True)
    pane = square((0, 0, 2), (9, 0, 0), (0, 9, 0), faint)
    light = DirectionalLight((0.2, -1, -0.5), (3, 3, 3))
    scene = Scene(meshes=(wall,), lights=(light,), camera=AHEAD, medium=fog)
    without, with_pane = (
        rendered(replace(scene, meshes=meshes), "single").radiance
        for meshes in ((wall,), (wall, pane))
    )
    assert np.abs(with_pane / without - 1.0).mean() < 3e-3
