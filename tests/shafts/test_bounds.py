"""Bounds of a shadow map against NumPy, for a side that is no power of two."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.scene import DirectionalLight, Mesh, Scene
from airlight.shafts.bounds import DepthBounds
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.shadow import ShadowMaps

SIDE = 21


def test_every_square_holds_its_texels(gpu: Gpu, square: Callable[..., Mesh]) -> None:
    meshes = (square((0, 0, 0), (0.4, 0.3, 0), (0, 0.2, 0.5)), square((0.3, -0.6, 0.2), (0.3, 0, 0),
                                                                      (0, 0, 0.2)))  # fmt: skip
    commands, maps = Commands(gpu), ShadowMaps(gpu, "test", SIDE, 2)
    lights = [DirectionalLight((0.2, -1, 0.1), (1, 1, 1)), DirectionalLight((1, -1, 0), (1, 1, 1))]
    views = light_views(lights, np.full(3, -1.0), np.full(3, 1.0), SIDE)
    maps.encode(commands, GpuScene(gpu, Scene(meshes=meshes)), views)
    bounds = DepthBounds(gpu, maps)
    bounds.encode(commands)
    commands.submit()
    assert bounds.side == 64
    stored = bounds.buffer.read().reshape(2, -1, 2)
    assert stored.shape[1] == 64 * 64
    depth = maps.depth.read()
    texels = stored[:, 64 * 32 :].reshape(2, 64, 64)
    np.testing.assert_array_equal(texels[:, :SIDE, :SIDE], depth)
    low, high = np.full((2, 64, 64), 1e30, np.float32), np.full((2, 64, 64), -1e30, np.float32)
    low[:, :SIDE, :SIDE] = high[:, :SIDE, :SIDE] = np.where(depth >= 1.0, np.float32(1e30), depth)
    assert 0 < np.count_nonzero(depth < 1.0) < depth.size
    for level in range(1, 7):
        n = 64 >> level
        low = low.reshape(2, n, 2, n, 2).min(axis=(2, 4))
        high = high.reshape(2, n, 2, n, 2).max(axis=(2, 4))
        expected = np.stack([low, high], axis=-1).reshape(2, -1, 2)
        # A level of n^2 squares begins at entry n^2.
        np.testing.assert_array_equal(stored[:, n * n : 2 * n * n], expected)
