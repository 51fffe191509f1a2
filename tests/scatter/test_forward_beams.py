"""Beams of what any media of a scene only scatter forwards, in cells and on surfaces."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.lpv.solver import LpvSolver
from airlight.maths.forward_beams import depths, passed_forwards
from airlight.rendering import Renderer
from airlight.scatter.forward_beams import ForwardBeams, ForwardSolver
from airlight.scatter.surface_beams import SurfaceBeams
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    Volume,
)
from airlight.scene.shapes import quad

SMALL = {
    "resolution": 16,
    "bounds": (-1.75, -0.5, -1.75, 1.75, 2.5, 1.75),
    "follow_walls": False,
    "shadow_resolution": 128,
    "lamp_resolution": 128,
    "map_resolution": 32,
    "sky_lights": 0,
    "surfels": 4000,
    "grid": 6,
    "ordinates": 4,
    "solver_steps": 4,
}
SIZE = (16, 12)
GREY = Material(base_color=(0.5,) * 3, specular=0.0)
DOWN = DirectionalLight((0.0, -1.0, 0.0), (2.0, 1.5, 1.0))
CAMERA = Camera((0.0, 3.0, 3.0), (0.0, 0.0, 0.0), fov_y_deg=40.0)
BOXES = np.array([[[-0.6, 0.9, -0.5], [0.2, 1.5, 0.6]], [[-0.1, 0.6, -0.7], [0.8, 1.1, 0.3]]])
ALBEDO, G = np.array([[0.9, 0.7, 1.0], [0.8, 1.0, 0.6]]), np.array([[0.6] * 3, [0.8, 0.5, 0.2]])
SIGMA_T = np.array([[2.0, 1.0, 3.0], [1.5, 2.5, 0.5]])


def level(side: float, height: float = 0.0) -> Mesh:
    """A horizontal square."""
    matrix = np.diag([side, 1.0, side, 1.0])
    matrix[1, 3] = height
    return Mesh(quad(), GREY, matrix)


def smokes(g: np.ndarray = G, *, has_shape: bool = True) -> tuple[Volume, ...]:
    """Two that overlap: a shape, or else another grid, and a grid of the same density all over."""
    return tuple(
        Volume(
            tuple(SIGMA_T[k]),
            None if has_shape and k == 0 else np.full((4, 4, 4), 1.0, np.float32),
            shape="box" if has_shape and k == 0 else "grid",
            bounds=(tuple(BOXES[k][0]), tuple(BOXES[k][1])),
            albedo=tuple(ALBEDO[k]),
            g=tuple(g[k]),
        )
        for k in range(2)
    )


def beams_of(scene: Scene, **settings: object) -> tuple[np.ndarray, np.ndarray, float]:
    """Fluence (z, y, x, channel), W m^-2, of cells; the middles of these; and their side, m."""
    with Renderer(scene, "auto", SIZE, settings={**SMALL, **settings}) as renderer:
        renderer.frame()
        solver = renderer.technique.find(LpvSolver)
        held = solver.media.beams.beams(0)
        place = renderer.technique.kit.placement
        if held is None:
            return np.zeros(0), np.zeros(0), place.cell
        states = held.read().reshape(3, *place.count[::-1], 4)[..., 0].astype(np.float64)
        z, y, x = np.meshgrid(*(np.arange(n) + 0.5 for n in place.count[::-1]), indexing="ij")
        middles = np.stack([x, y, z], -1) * place.cell + np.array(place.origin)
        np.testing.assert_allclose(place.axes, np.eye(3), atol=1e-6)
        middles += np.array(renderer.origin)
        return np.moveaxis(states, 0, -1) / place.cell**3, middles, place.cell


def above_floor(middles: np.ndarray, cell: float) -> int:
    """The cells that stand on the floor, a row along y."""
    row = int(np.argmin(np.abs(middles[0, :, 0, 1] - 0.5 * cell)))
    assert middles[0, row, 0, 1] == pytest.approx(0.5 * cell, abs=1e-6)
    return row


def columns(points: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Metres in each of the boxes on the path to a light; (..., 2)."""
    path = light - points
    reach = np.linalg.norm(path, axis=-1)
    found = []
    for low, high in BOXES:
        with np.errstate(divide="ignore"):
            ends = np.sort([(low - points) / path, (high - points) / path], axis=0)
        near, far = np.clip(ends[0].max(-1), 0.0, 1.0), np.clip(ends[1].min(-1), 0.0, 1.0)
        found.append(np.maximum(far - near, 0.0) * reach)
    return np.stack(found, -1)


def test_cells_hold_what_numpy_says_of_a_local_light():
    """The mean over eight parts of a cell; depths of media of both kinds add up."""
    local_light = PointLight((0.3, 4.0, 0.2), (9.0, 7.0, 5.0))
    scene = Scene((level(3.0),), (local_light,), camera=CAMERA, volumes=smokes(has_shape=False))
    found, middles, cell = beams_of(scene)
    offsets = (np.array(np.meshgrid(*[[-0.25, 0.25]] * 3)).reshape(3, -1).T) * cell
    parts = middles[..., None, :] + offsets
    passed = passed_forwards(
        *depths(columns(parts, np.array(local_light.position)), SIGMA_T, ALBEDO, G)
    )
    distance = np.linalg.norm(parts - np.array(local_light.position), axis=-1)
    truth = (passed * np.array(local_light.intensity) / distance[..., None] ** 2).mean(axis=-2)
    # Cells that the floor reads, in the middle of it.
    row = above_floor(middles, cell)
    inner = (slice(4, -4), row, slice(4, -4))
    assert truth[inner].max() > 0.1
    np.testing.assert_allclose(found[inner], truth[inner], atol=0.02 * truth[inner].max())


def test_a_directional_lights_beams_spread_and_lose_nothing():
    """Beyond the volumes' shadow, too, where the straight path meets none of them."""
    found, middles, cell = beams_of(Scene((level(4.0),), (DOWN,), camera=CAMERA, volumes=smokes()))
    row = above_floor(middles, cell)
    found, side = found[:, row], (np.arange(8) - 3.5) * cell / 8
    x, z = (grid.ravel() for grid in np.meshgrid(side, side))
    parts = middles[:, row, :, None] + np.stack([x, 0.0 * x, z], axis=-1)
    far = np.array([0.0, 1e4, 0.0])
    passed = passed_forwards(*depths(columns(parts, parts + far), SIGMA_T, ALBEDO, G))
    truth = passed.mean(axis=-2) * np.array(DOWN.irradiance)
    # Half of it would be left without those beside the shadow.
    np.testing.assert_allclose(found.sum((0, 1)) / truth.sum((0, 1)), 1.0, atol=0.08)
    beside = truth[..., 0] == 0.0
    assert 0.1 < found[beside].sum() / found.sum() < 0.6


def test_opaque_surfaces_keep_beams_off():
    plate = level(3.0, 2.0)
    lit, middles, cell = beams_of(Scene((level(4.0),), (DOWN,), camera=CAMERA, volumes=smokes()))
    shaded, _, _ = beams_of(Scene((level(4.0), plate), (DOWN,), camera=CAMERA, volumes=smokes()))
    row = above_floor(middles, cell)
    assert lit[:, row].max() > 0.1
    assert shaded[:, row].max() < 0.01 * lit[:, row].max()


@pytest.mark.parametrize("g", [0.0, -0.4])
def test_there_are_none_where_nothing_is_scattered_forwards(g):
    scene = Scene((level(3.0),), (DOWN,), camera=CAMERA, volumes=smokes(np.full((2, 3), g)))
    found, _, _ = beams_of(scene)
    assert found.size == 0


def wide(g: float) -> Volume:
    """Smoke above all of a floor."""
    return Volume((1.5,) * 3, shape="box", bounds=((-9, 0.5, -9), (9, 1.5, 9)), albedo=(0.8,) * 3,
                  g=(g,) * 3)  # fmt: skip


def test_a_floor_reads_the_beams_that_pass():
    """Straight from above, where borders are far: E (T' - T) albedo/pi, in a moving frame."""
    scene = Scene((level(2.0),), (DOWN,), camera=CAMERA, volumes=(wide(0.6),))
    settings = dict(SMALL)
    settings.pop("map_resolution")
    with Renderer(scene, "pop", SIZE, settings=settings) as renderer:
        image = renderer.frame()
        solver = renderer.technique.find(ForwardSolver)
        assert isinstance(solver.beams, ForwardBeams)
        assert isinstance(solver.beams._made.surfaces, SurfaceBeams)
    expected = np.exp(-1.5 * (1.0 - 0.48)) - np.exp(-1.5)
    expected = expected * np.array(DOWN.irradiance) * 0.5 / np.pi
    found = (image.layers["indirect"] / image.layers["transmittance"])[5:7, 6:10].mean((0, 1))
    np.testing.assert_allclose(found, expected, rtol=0.04)


@pytest.mark.parametrize("technique", ["auto", "pop"])
def test_a_frame_does_not_depend_on_those_before(technique):
    """Light, smoke and a plate that moved, under a sky, and back."""
    sky = Environment((0.5, 0.6, 0.8))
    settings = {**SMALL, "sky_lights": 8, "sky_resolution": 16}
    if technique == "pop":
        settings.pop("map_resolution")
    before = Scene((level(3.0), level(0.5, 0.4)), (DOWN,), environment=sky, camera=CAMERA,
                   volumes=smokes())  # fmt: skip
    turned = DirectionalLight((0.3, -1.0, 0.1), DOWN.irradiance)
    thinner = dataclasses.replace(before.volumes[1], density=np.full((4, 4, 4), 0.5, np.float32))
    after = dataclasses.replace(
        before,
        meshes=(before.meshes[0], level(0.8, 0.5)),
        lights=(turned,),
        volumes=(before.volumes[0], thinner),
    )
    with Renderer(before, technique, SIZE, settings=settings) as renderer:
        renderer.frame()
        moved = renderer.frame(meshes=after.meshes, lights=after.lights, volumes=after.volumes)
        again = renderer.frame(meshes=before.meshes, lights=before.lights, volumes=before.volumes)
    with Renderer(before, technique, SIZE, settings=settings) as renderer:
        first = renderer.frame()
        other = renderer.frame(meshes=after.meshes, lights=after.lights, volumes=after.volumes)
    np.testing.assert_array_equal(again.radiance, first.radiance)
    np.testing.assert_array_equal(moved.radiance, other.radiance)
    assert np.abs(moved.radiance - again.radiance).max() > 0.01
