"""An endless medium: beside quadrature of a half space, and no border where the lattice ends."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.half_space import plane_light
from airlight.maths.octahedron import octahedron_point
from airlight.media.march.half_space import ROWS, SIDE, HalfSpace, fluence, sky_single_scatter
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Environment, Material, Medium, Mesh, Scene
from airlight.scene.shapes import quad
from airlight.surface.sky import sky_lights

SUN = DirectionalLight((0.0, -0.6, -0.8), (3.0, 2.0, 1.0))
AIR = Medium(0.1, 0.9, endless=True, top=10.0)
SIZE = (16, 12)
FULL = {
    "shaft_resolution": "full",
    "march_resolution": "full",
    "resolution": 8,
    "shadow_resolution": 64,
    "map_resolution": 32,
    "sky_lights": 32,
    "sky_resolution": 16,
    "surfels": 1000,
}


def small_plate(lights=(SUN,), environment=None, medium=AIR, target=(0.0, 4.0, -10.0)) -> Scene:
    """Next to nothing in a wide space: all that is seen is the medium far away."""
    plate = Mesh(quad(), Material(base_color=(0.0, 0.0, 0.0)))
    camera = Camera((0.0, 2.0, 20.0), target, fov_y_deg=50.0)
    return Scene(
        meshes=(plate,), lights=lights, environment=environment, medium=medium, camera=camera
    )


def rays(scene: Scene) -> np.ndarray:
    """(H, W, 3): directions through pixel centres."""
    width, height = SIZE
    forward = np.subtract(scene.camera.target, scene.camera.position)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, scene.camera.up)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    tall = np.tan(np.radians(scene.camera.fov_y_deg) / 2.0)
    x = (2.0 * (np.arange(width) + 0.5) / width - 1.0) * tall * width / height
    y = (1.0 - 2.0 * (np.arange(height) + 0.5) / height) * tall
    directions = forward + x[None, :, None] * right + y[:, None, None] * up
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def along_rays(scene: Scene, emission) -> np.ndarray:
    """(H, W): integral of emission(height) exp(-sigma t) along each ray, by quadrature."""
    directions, eye = rays(scene), scene.camera.position[1]
    t = np.concatenate([[0.0], np.geomspace(1e-2, 150.0, 800)])
    middle, dt = 0.5 * (t[1:] + t[:-1]), np.diff(t)
    heights = eye + directions[..., 1:2] * middle
    emitted = np.where(heights < AIR.top, emission(heights), 0.0)
    return (emitted * np.exp(-0.1 * middle) * dt).sum(-1)


@pytest.mark.parametrize("technique", ["single", "lpv-scatter"])
def test_a_sun_in_an_endless_medium_is_a_half_spaces(gpu, technique):
    scene = small_plate()
    with Renderer(scene, technique, SIZE, settings=_known(technique)) as renderer:
        image = renderer.frame()

    def once(heights):
        beam = np.exp(-0.1 * (AIR.top - heights) / 0.6) * SUN.irradiance[0]
        return 0.09 * beam / (4.0 * np.pi)

    np.testing.assert_allclose(
        image.layers["single_scatter"][..., 0], along_rays(scene, once), rtol=0.02, atol=1e-4
    )
    light = plane_light(0.9, np.array([0.6]), np.array([SUN.irradiance[0]]))

    def again(heights):
        depth = 0.1 * (AIR.top - heights)
        return 0.09 * np.interp(depth, light.depth, light.scattered) / (4.0 * np.pi)

    if technique == "lpv-scatter":
        truth = along_rays(scene, again)
        many = image.layers["multiple_scatter"][..., 0]
        assert np.linalg.norm(many - truth) < 0.02 * np.linalg.norm(truth)


def test_a_skys_light_scatters_once_in_the_half_space(gpu):
    """A bright uniform sky: light of the upper half of all directions, each through its depth."""
    scene = small_plate((), Environment(radiance=(1.0, 1.0, 1.0)))
    with Renderer(scene, "single", SIZE, settings=_known("single")) as renderer:
        image = renderer.frame()
    nodes, weights = np.polynomial.legendre.leggauss(48)
    mu, w = 0.5 * (nodes + 1.0), 0.5 * weights

    def once(heights):
        depth = np.maximum(0.1 * (AIR.top - heights), 0.0)
        table = np.linspace(0.0, 20.0, 400)
        fluence = 2.0 * np.pi * (np.exp(-table[:, None] / mu) @ w)
        return 0.09 * np.interp(depth, table, fluence) / (4.0 * np.pi)

    truth = along_rays(scene, once)
    ours = image.layers["single_scatter"][..., 0]
    # 32 lights stand for the sky.
    assert np.linalg.norm(ours - truth) < 0.05 * np.linalg.norm(truth)


def test_an_open_scene_has_no_box_of_light(gpu):
    """Across where the lattice ends, light beside the plate changes as smoothly as beyond it."""
    scene = small_plate(target=(0.0, 2.0, 0.0))
    with Renderer(scene, "lpv-scatter", (64, 3), settings=_known("lpv-scatter")) as renderer:
        row = renderer.frame().layers["multiple_scatter"][1, :, 0].astype(np.float64)
    assert np.abs(np.diff(row)).max() < 0.02 * row.mean()


def test_rows_follow_the_half_space(gpu, owned):
    far = owned(HalfSpace(gpu))
    source = far.update(AIR, 10.0, (SUN,), (), is_lattice=True)
    read = np.frombuffer(source.table.read(), np.float32)[: ROWS * 3 * 4].reshape(ROWS, 3, 4)
    light = plane_light(0.9, np.array([0.6]), np.array([2.0]))
    assert source.side == 1
    assert read[0, 0, 1] == pytest.approx(light.scattered[0] / (4.0 * np.pi), rel=1e-5)
    assert (read[:, 1:] == 0.0).all() and source.sigma_t == pytest.approx(0.1)
    again = far.update(AIR, 10.0, (SUN,), (), is_lattice=True)
    assert again is source


def test_a_sky_scatters_all_its_light_whatever_g_is():
    """Over all directions, by quadrature on the octahedron's square, what arrives."""
    uneven = Medium(0.1, 0.9, 0.6, endless=True, top=10.0)
    sky = sky_lights(Environment(radiance=(1.0, 1.0, 1.0)), 64)
    made = sky_single_scatter(uneven, sky).reshape(ROWS, SIDE, SIDE, 3)
    # Texels at borders and corners stand for less of the square; solid angle per area of it.
    t = np.linspace(-1.0, 1.0, SIDE)
    u, v = np.meshgrid(t, t)
    area = np.outer(*[np.where(np.abs(t) < 1.0, 1.0, 0.5)] * 2) * (2.0 / (SIDE - 1)) ** 2
    solid = area / np.linalg.norm(octahedron_point(np.stack([u, v], -1)), axis=-1) ** 3
    total = np.einsum("rijc,ij->rc", made, solid)
    np.testing.assert_allclose(total, fluence(uneven, sky, is_reduced=False), rtol=0.02, atol=1e-9)


def _known(technique: str) -> dict[str, object]:
    from dataclasses import fields

    from airlight.techniques import technique_settings

    names = {field.name for field in fields(technique_settings(technique))}
    return {key: value for key, value in FULL.items() if key in names}
