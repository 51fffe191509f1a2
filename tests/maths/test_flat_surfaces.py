"""Flat surfaces in maps of lights: closed forms, and the shaders' twins over a drawn map."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, buffer_of
from airlight.gpu.slots import storage, uniform
from airlight.lattice.inject import MAP_SLOTS, InjectParams, map_bound
from airlight.lattice.placement import LatticeParams, Placement
from airlight.maths import flat_surfaces as flat
from airlight.scene import DirectionalLight, Material, Mesh, Scene, SpotLight
from airlight.scene.shapes import sphere
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.reflective import ReflectiveShadowMaps

SIDE = 64
ROOM = Placement((-2.0, -2.0, -2.0), 0.25, (16, 16, 16))
RNG = np.random.default_rng(5)
MAIN = """
//! use flat_surfaces
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&points)) {
        let p = points[id.x].xyz;
        let n = normals[id.x].xyz;
        let sight = sight_of(row_of_views(0u), p, n);
        results[id.x] = vec2f(flatness(sight, 0u, n), clearance(sight, 0u, n));
    }
}
"""


def unit(count):
    d = RNG.normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def plane(height=lambda x, y: 0.0 * x):
    """A map straight down on heights over x and y of -1 to 1 m, its depth from 1 m to -1 m."""
    axis = (np.arange(SIDE) + 0.5) / SIDE * 2.0 - 1.0
    x, y = np.meshgrid(axis, -axis)
    return flat.DepthMap(0.5 - 0.5 * height(x, y), np.diag([1.0, 1.0, -0.5, 1.0]) + HALF)


HALF = np.zeros((4, 4))
HALF[2, 3] = 0.5
UP = np.array([[0.0, 0.0, 1.0]])
ORIGIN = np.zeros((1, 3))


def test_axes_across_are_unit_vectors_whose_weights_are_two():
    n = unit(200)
    axes = np.stack([flat.axis_across(n, k) for k in range(3)], axis=1)
    np.testing.assert_allclose(np.linalg.norm(axes[..., :3], axis=-1), 1.0)
    np.testing.assert_allclose((axes[..., :3] * n[:, None]).sum(-1), 0.0, atol=1e-12)
    np.testing.assert_allclose(axes[..., 3].sum(axis=1), 2.0)
    # Along an axis the other two are left.
    axes = np.stack([flat.axis_across(UP, k)[0] for k in range(3)])
    np.testing.assert_allclose(axes[:2], [[1, 0, 0, 1], [0, 1, 0, 1]], atol=1e-12)
    assert axes[2, 3] == 0.0


def test_planes_are_flat_and_steps_and_rims_are_less():
    assert flat.flatness(plane(), ORIGIN, UP, 0.25) == pytest.approx(1.0)
    # A step of a cell beside the point, half a cell away: one of four points along the axes.
    step = plane(lambda x, y: np.where(x > 0.1, -0.25, 0.0))
    assert flat.flatness(step, ORIGIN, UP, 0.25) == pytest.approx(0.75)
    # Beyond the map's border nothing is known.
    corner = np.array([[1.0, 1.0, 0.0]])
    assert flat.flatness(plane(), corner - 0.01, UP, 0.25) == pytest.approx(0.5)
    # A ball of a cell's radius sinks by .13 cells there; one of half a cell by a half.
    ball = plane(lambda x, y: np.sqrt(np.maximum(0.25**2 - x**2 - y**2, 0.0)) - 0.25)
    assert 0.6 < flat.flatness(ball, ORIGIN, UP, 0.25) < 0.9
    assert flat.flatness(ball, ORIGIN, UP, 0.5) == 0.0


def test_walls_before_a_plane_are_not_clear():
    slanted = np.array([[0.6, 0.0, 0.8]])
    alone = plane(lambda x, y: -0.75 * x)
    assert flat.clearance(alone, ORIGIN, slanted, 0.25) == pytest.approx(1.0)
    # What it shows past a point before a plane, and is before that, too.
    wall = plane(lambda x, y: np.where(x > 0.05, 0.5, -0.75 * x))
    assert flat.clearance(wall, ORIGIN, slanted, 0.25) == 0.0
    np.testing.assert_array_equal(flat.is_open(np.array([-3.0, 0.25, 0.6])), [1.0, 1.0, 0.0])


@pytest.mark.parametrize(
    "light",
    [
        DirectionalLight((0.4, -1, 0.2), (1, 1, 1)),
        SpotLight((0.3, 1.7, 0.2), (0, -1, 0), (2, 2, 2)),
    ],
)
def test_shaders_find_what_numpy_finds_in_the_same_map(gpu, commands, owned, kernel, square, light):
    # A slanted floor, a wall before it, a ball: what is flat, what is not, what is between.
    turned = np.array([0.96, 0.28, 0.0])
    paint = Material(base_color=(0.5, 0.5, 0.5))
    meshes = (
        square((0, -0.5, 0), 1.5 * turned, (0, 0, -1.5), paint),
        square((0.2, -0.3, 0), 0.4 * turned, (0, 0, -0.5), paint),
        Mesh(sphere(), paint, np.diag([0.3, 0.3, 0.3, 1.0])),
    )
    scene = owned(GpuScene(gpu, Scene(meshes=meshes)))
    views = light_views([light], *scene.bounds, SIDE)
    maps = owned(ReflectiveShadowMaps(gpu, "maps", SIDE, len(views)))
    maps.encode(commands, scene, [light], views)

    # Points about the floor, with its normal or any.
    p = RNG.uniform([-1.4, 0.0, -1.4], [1.4, 0.0, 1.4], (500, 3))
    p[:, 1] = -0.5 + p[:, 0] * turned[1] / turned[0]
    n = np.where(np.arange(500)[:, None] % 2 == 0, [-turned[1], turned[0], 0.0], unit(500))
    rows = np.zeros((2, 500, 4), np.float32)
    rows[0, :, :3], rows[1, :, :3] = p, n
    results = owned(Buffer(gpu, "results", 500 * 8))
    slots = (
        uniform("lattice", LatticeParams),
        uniform("params", InjectParams),
        *MAP_SLOTS[:2],
        storage("points", "vec4f"),
        storage("normals", "vec4f"),
        storage("results", "vec2f", "read_write"),
    )
    bound = map_bound(maps)
    kernel(MAIN, slots).dispatch(
        commands,
        (500,),
        lattice=ROOM.params(1.0),
        params=InjectParams.of(
            resolution=SIDE, layers=1, block=1, least=0.0, next_least=0.0, has_static=0
        ),
        views=bound["views"],
        depth=bound["depth"],
        points=owned(buffer_of(gpu, "points", rows[0])),
        normals=owned(buffer_of(gpu, "normals", rows[1])),
        results=results,
    )
    commands.submit()

    shown = flat.DepthMap(maps.depth.read(0).astype(np.float64), views[0].clip_from_world)
    p, n = rows[..., :3].astype(np.float64)
    expected = np.stack([f(shown, p, n, ROOM.cell) for f in (flat.flatness, flat.clearance)], 1)
    assert expected.min(axis=0).max() < 0.1
    assert expected.max(axis=0).min() > 0.9
    # Beside a texel's border float32 reads the next texel; the depths of a near light are coarse.
    off = np.abs(results.read().reshape(-1, 2) - expected).max(axis=1)
    assert (off < 5e-3).mean() > 0.98
