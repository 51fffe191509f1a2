"""Noise finer than the voxels: the mean stays, the image is finer, nothing else changes."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.media.detail import detail_bias, detail_noise
from airlight.media.gpu_media import GpuMedia
from airlight.media.march.march import March, MarchTargets
from airlight.media.march.marched_light import MarchedLight
from airlight.media.rays import Rays
from airlight.scene.camera import Camera
from airlight.scene.scene import Scene
from airlight.scene.volume import Volume

GRID = Volume((0.02,) * 3, np.ones((24, 24, 24), np.float32), bounds=((-1.0,) * 3, (1.0,) * 3))
CAMERA = Camera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0), fov_y_deg=30)


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 3.0, 10.0])
def test_the_mean_factor_is_one(amplitude):
    noise = detail_noise().astype(np.float64)
    assert noise.std() == pytest.approx(1.0, abs=1e-3)
    factor = np.exp(amplitude * noise + detail_bias(amplitude))
    assert factor.mean() == pytest.approx(1.0, rel=1e-9)


def depth(gpu: Gpu, look: Any, volume: Volume) -> NDArray[Any]:
    """Optical depth of an image inside the box's silhouette."""
    seen = look(Scene(volumes=(volume,), camera=CAMERA))
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays = Rays(gpu, seen.size, 1)
    L, T = (
        Texture(gpu, n, rays.reduced, "rgba32float", target=True, written=True) for n in ("L", "T")
    )
    rays.encode(seen.commands, seen.view)
    March(gpu, air).encode(seen.commands, rays, MarchedLight(), MarchTargets(L, T))
    return np.asarray(-np.log(seen.read(T)[..., 0]))


def test_a_volume_keeps_its_mass_and_gets_detail(gpu, look):
    plain, rough = (
        depth(gpu, look, dataclasses.replace(GRID, detail=detail)) for detail in (0.0, 0.8)
    )
    assert rough.mean() == pytest.approx(plain.mean(), rel=0.03)
    rows, columns = plain.shape
    middle = (slice(rows // 3, -rows // 3), slice(columns // 2 - 2, columns // 2 + 3))
    assert plain[middle].std() < 0.02 * plain[middle].mean()
    assert rough[middle].std() > 0.05 * plain[middle].mean()
