"""How fine columns towards lights are, and the shadow of dense matter that they make."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from airlight.media.column_texels import Fineness, all_texels
from airlight.rendering import render
from airlight.scene import Camera, DirectionalLight, Material, Mesh, Scene, Volume
from airlight.scene.shapes import quad

LIMIT = 2048
SUN = DirectionalLight((0.8, -0.6, 0.0), (3.0,) * 3)
VOXELS = 96


def matter(per_m: float, voxels: int = VOXELS) -> Volume:
    """A grid of 2 m whose densest voxel has an extinction of `per_m`."""
    density = np.zeros((voxels, voxels, voxels // 2), np.float32)
    density[1, 1, 1] = 2.0
    return Volume((0.5 * per_m,) * 3, density, bounds=((0, 0, 0), (1, 2, 2)))


def texels(*volumes: Volume, most: int = 48, depth: float = 1.0, groups: int = 1) -> list[object]:
    return list(all_texels(volumes, Fineness(most, depth=depth), groups, LIMIT))


def test_thin_matter_has_few_and_dense_matter_as_many_as_its_depth_asks() -> None:
    assert texels(matter(20.0)) == [(24, 48, 48)]
    assert texels(matter(40.0)) == [(40, 80, 80)]
    assert texels(matter(1e4)) == [(72, 144, 144)]
    assert texels(matter(1e4), depth=math.inf) == [(24, 48, 48)]


def test_two_a_voxel_are_enough() -> None:
    assert texels(matter(1e4, voxels=20)) == [(20, 40, 40)]


def test_where_all_have_no_room_none_is_finer() -> None:
    few = [(24, 48, 48)]
    assert texels(matter(1e4), groups=15) == few, "15 times 144 texels along z"
    assert texels(*[matter(1e4)] * 12) == few * 12, "12 MB each"
    assert texels(*[matter(1e4)] * 11) == [(72, 144, 144)] * 11


def ball() -> np.ndarray:
    """(z, y, x): a ball whose rim is three voxels wide."""
    z, y, x = (np.indices((VOXELS,) * 3) + 0.5) / VOXELS * 2.0 - 1.0
    rim = (0.8 - np.sqrt(x * x + y * y + z * z)) * VOXELS / 2.0 / 3.0 + 0.5
    return np.clip(rim, 0.0, 1.0).astype(np.float32)


def along(density: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Metres at density 1 from points (n, 3) to the sun, through `density` in its box of 2 m."""
    steps = np.linspace(0.0, 4.0, 400)
    sum_of = np.zeros(len(points))
    for step in steps:
        at = (points - step * np.array(SUN.direction) + 1.0) * VOXELS / 2.0 - 0.5
        first = np.floor(at).astype(int)
        share = at - first
        for corner in np.ndindex(2, 2, 2):
            index = first + corner
            weight = np.abs(1.0 - np.array(corner) - share).prod(axis=1)
            is_in = ((index >= 0) & (index < VOXELS)).all(axis=1)
            x, y, z = np.where(is_in[:, None], index, 0).T
            sum_of += np.where(is_in, weight * density[z, y, x], 0.0)
    return np.asarray(sum_of * (steps[1] - steps[0]))


def test_the_shadow_of_dense_matter_has_a_smooth_edge(gpu: object) -> None:
    """Of a ball that lies beside the view, beside the exact integral at every pixel."""
    place = np.diag([9.0, 1.0, 9.0, 1.0])
    place[1, 3] = -1.2
    size = (64, 64)
    scene = Scene(
        meshes=(Mesh(quad(), Material(base_color=(0.5,) * 3, specular=0.0), place),),
        lights=(SUN,),
        camera=Camera((2.4, 8.8, 0.6), (2.4, -1.2, 0.6), (0, 0, -1), 2 * math.degrees(0.04)),
    )
    density = ball()
    solid = Volume((80.0,) * 3, density)
    pair = [
        render(replace(scene, volumes=volumes), "single", size, samples=1).layers["direct"]
        for volumes in ((solid,), ())
    ]
    passed = (pair[0] / pair[1])[..., 0].astype(np.float64)
    at = ((np.arange(64) + 0.5) / 32.0 - 1.0) * 10.0 * math.tan(0.04)
    x, z = np.meshgrid(2.4 + at, 0.6 + at)
    points = np.stack([x, np.full_like(x, -1.2), z], axis=-1).reshape(-1, 3)
    exact = np.exp(-80.0 * along(density, points)).reshape(64, 64)
    assert 0.2 < exact.mean() < 0.8
    off = math.sqrt(float(((passed - exact) ** 2).mean()))
    assert off < 0.035, "columns of 144 texels: .025; of 48: .091"
