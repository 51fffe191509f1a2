"""The table of media, what is refused, and the grids' columns towards lights."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.media.gpu_media import GpuMedia, medium_box
from airlight.media.media_rows import voxel_m
from airlight.media.media_slots import light_groups
from airlight.scene import Camera, DirectionalLight, Medium, PointLight, Scene, Volume


def test_a_medium_without_bounds_holds_the_camera() -> None:
    low, high = medium_box(Medium((1, 1, 1)), np.zeros(3), np.ones(3), (3.0, 0.5, -1.0))
    assert np.all(low < [0, 0, -1])
    assert np.all(high > [3, 1, 1])
    assert np.all(high - low < [3.1, 1.1, 2.1])
    bounded = Medium((1, 1, 1), bounds=((0, 0, 0), (1, 2, 3)))
    np.testing.assert_array_equal(
        medium_box(bounded, np.zeros(3), np.ones(3), (9, 9, 9)), bounded.bounds
    )


def test_voxels_are_measured_in_the_world() -> None:
    grid = Volume(
        (1, 1, 1),
        density=np.ones((4, 5, 8), np.float32),
        bounds=((0, 0, 0), (8, 10, 4)),
        world_from_volume=np.diag([0.5, 1, 3, 1]),
    )
    assert voxel_m(grid) == pytest.approx(0.5)


def test_too_much_air_is_refused(gpu: Gpu) -> None:
    grid = Volume((1, 1, 1), density=np.ones((2, 2, 2), np.float32))
    with pytest.raises(SceneError) as caught:
        GpuMedia(gpu, Scene(volumes=(grid,) * 257), light_count=0)
    assert str(caught.value) == (
        "the scene has 257 media, at most 256 can be drawn at once. "
        "Merge some of the volumes into one grid"
    )


def test_media_keep_their_kinds(gpu: Gpu) -> None:
    scene = Scene(medium=Medium((1, 1, 1)))
    air = GpuMedia(gpu, scene, light_count=0)
    ball = Volume((1, 1, 1), shape="sphere")
    changed = dataclasses.replace(scene, volumes=(ball,))
    with pytest.raises(SceneError, match="media changed in kind"):
        air.update(Commands(gpu), changed, *scene.bounds)


def mean_densities(gpu: Gpu, density: np.ndarray, *lights: Any) -> np.ndarray:
    """(z, y, x, light) towards the lights."""
    grid = Volume((1, 1, 1), density=density, bounds=((0, 0, 0), (2, 1, 3)))
    scene = Scene(volumes=(grid,), lights=lights, camera=Camera((0, 0, 9), (0, 0, 0)))
    air, commands = GpuMedia(gpu, scene, light_count=len(lights)), Commands(gpu)
    air.update(commands, scene, *scene.bounds)
    commands.submit()
    assert air.columns is not None
    texels = air.columns.texture.read().astype(np.float64)
    # Up to twice as many texels as voxels.
    slabs = texels.reshape(light_groups(len(lights)), -1, *texels.shape[1:])
    return np.concatenate(list(slabs), axis=-1)[..., : len(lights)]


def test_even_density_has_itself_as_mean(gpu: Gpu) -> None:
    """Five lights: two slabs of four. One lamp is inside the grid."""
    sun = DirectionalLight((0.3, -1, 0.2), (1, 1, 1))
    light = PointLight((0.7, 0.4, 1.9), (1, 1, 1))
    means = mean_densities(gpu, np.full((6, 3, 4), 0.5, np.float32), sun, sun, light, sun, light)
    np.testing.assert_allclose(means, 0.5, rtol=1e-3)


def test_means_follow_the_density(gpu: Gpu) -> None:
    """Density rises linearly with x, so the mean from -x is half of it, and on to a lamp."""
    n = 32
    voxel = (np.arange(n) + 0.5) * 2.0 / n
    density = np.broadcast_to(voxel, (3, 4, n)).astype(np.float32).copy()
    light = PointLight((1.2, 0.5, 1.5), (1, 1, 1))
    means = mean_densities(gpu, density, DirectionalLight((1, 0, 0), (1, 1, 1)), light)
    shape = means.shape[:3]
    assert shape == (5, 6, 48)
    x = np.linspace(0, 2, shape[2])
    np.testing.assert_allclose(means[..., 0], np.broadcast_to(0.5 * x, shape), atol=4e-2)
    np.testing.assert_allclose(means[..., 1], np.broadcast_to(0.5 * (x + 1.2), shape), atol=4e-2)
