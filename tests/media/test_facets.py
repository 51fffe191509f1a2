"""Facets of a shadow map: they tile it, lie on its depths, and no light leaks between them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.media.shafts.facets import FacetTrees
from airlight.scene import DirectionalLight, Mesh, PointLight, Scene
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.shadow import ShadowMaps

SIDE = 21
LID, WALL, KINDS = 14, 28, 52


def trees_of(gpu: Gpu, meshes: tuple[Mesh, ...], *, local_light: bool) -> FacetTrees:
    light = (
        PointLight((0.1, 0.2, 0.0), (1, 1, 1))
        if local_light
        else DirectionalLight((0.2, -1, 0.1), (1, 1, 1))
    )
    views = light_views([light], np.full(3, -1.0), np.full(3, 1.0), SIDE)
    commands, maps = Commands(gpu), ShadowMaps(gpu, "test", SIDE, len(views))
    maps.encode(commands, GpuScene(gpu, Scene(meshes=meshes)), views)
    trees = FacetTrees(gpu, maps, 0.5)
    trees.encode(commands)
    commands.submit()
    return trees


def listed(trees: FacetTrees, layer: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(level, x and y, kind) of a layer's triangles, decoded apart from the shader."""
    count = trees.draws.read(np.uint32)[4 * layer] // 3
    packed = trees.triangles[layer].read(np.uint32)[:count].astype(np.int64)
    firsts = np.cumsum([0, *(4**k for k in range(trees.top, -1, -1))])
    level = np.searchsorted(firsts, packed // KINDS, side="right") - 1
    inside = packed // KINDS - firsts[level]
    width = trees.side >> level
    return level, np.stack([inside % width, inside // width], axis=-1), packed % KINDS


def cluttered(square: Callable[..., Mesh]) -> tuple[Mesh, ...]:
    rng = np.random.default_rng(3)
    return tuple(
        square(rng.uniform(-0.8, 0.8, 3), rng.uniform(-0.3, 0.3, 3), rng.uniform(-0.3, 0.3, 3))
        for _ in range(12)
    )


@pytest.mark.parametrize("local_light", [False, True])
def test_tops_tile_what_the_map_sees(
    gpu: Gpu, square: Callable[..., Mesh], local_light: bool
) -> None:
    trees = trees_of(gpu, cluttered(square), local_light=local_light)
    depth = trees.maps.depth.read().reshape(-1, SIDE, SIDE)
    for layer in range(trees.maps.layers):
        level, place, kind = listed(trees, layer)
        shares = np.array([0.5, 0.5] + [0.25] * 4 + [0.125] * 8)
        for first in (0, LID):
            covered = np.zeros((trees.side, trees.side))
            chosen = (kind >= first) & (kind < first + LID)
            for k, (x, y), share in zip(
                level[chosen], place[chosen], shares[kind[chosen] - first], strict=True
            ):
                covered[y << k : y + 1 << k, x << k : x + 1 << k] += share
            expected = np.zeros_like(covered)
            expected[:SIDE, :SIDE] = depth[layer] < 1.0
            np.testing.assert_array_equal(covered, expected)


def test_a_plane_is_a_few_facets(gpu: Gpu, square: Callable[..., Mesh]) -> None:
    floor = (square((0, 0, 0), (5, 0.4, 0), (0, 0.3, -5)),)
    trees = trees_of(gpu, floor, local_light=False)
    depth = trees.maps.depth.read()
    level, place, kind = listed(trees, 0)
    tops = kind < LID
    assert np.count_nonzero(tops) < 0.35 * 2 * SIDE * SIDE
    planes = trees.planes.read().reshape(-1, 4)
    firsts = np.cumsum([0, *(4**k for k in range(trees.top - 1, -1, -1))])
    for k, (x, y) in zip(level[tops], place[tops], strict=True):
        if k == 0:
            continue
        c, sx, sy, _ = planes[firsts[k - 1] + y * (trees.side >> k) + x]
        rows, columns = np.mgrid[y << k : y + 1 << k, x << k : x + 1 << k] + 0.5
        plane = c + sx * (columns - (x + 0.5) * 2**k) + sy * (rows - (y + 0.5) * 2**k)
        seen = depth[y << k : y + 1 << k, x << k : x + 1 << k]
        np.testing.assert_allclose(plane, seen, atol=1e-5)


def test_neighbours_differ_by_one_level(gpu: Gpu, square: Callable[..., Mesh]) -> None:
    floor = square((0, 0, 0), (5, 0, 0), (0, 0, -5))
    post = square((0.11, 0.3, 0.13), (0.04, 0, 0), (0, 0, -0.04))
    trees = trees_of(gpu, (floor, post), local_light=False)
    level, place, kind = listed(trees, 0)
    levels = np.full((trees.side, trees.side), -1)
    for k, (x, y) in zip(level[kind < LID], place[kind < LID], strict=True):
        levels[y << k : y + 1 << k, x << k : x + 1 << k] = k
    seen = levels[:SIDE, :SIDE]
    assert seen.min() == 0
    assert seen.max() >= 2
    assert np.abs(np.diff(seen, axis=0)).max() <= 1
    assert np.abs(np.diff(seen, axis=1)).max() <= 1


def test_it_is_the_same_in_every_run(gpu: Gpu, square: Callable[..., Mesh]) -> None:
    runs = [trees_of(gpu, cluttered(square), local_light=True) for _ in range(2)]
    for layer in range(6):
        a, b = (listed(trees, layer) for trees in runs)
        for x, y in zip(a, b, strict=True):
            np.testing.assert_array_equal(x, y)
