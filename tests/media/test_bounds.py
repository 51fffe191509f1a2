"""Bounds of a shadow map against NumPy, for a side that is no power of two."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.media.shafts.bounds import DepthBounds
from airlight.scene import DirectionalLight, Mesh, Scene
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.shadow import ShadowMaps

SIDE = 21


def test_every_square_holds_its_texels(gpu: Gpu, square: Callable[..., Mesh]) -> None:
    meshes = (
        square((0, 0, 0), (0.4, 0.3, 0), (0, 0.2, 0.5)),
        square((0.3, -0.6, 0.2), (0.3, 0, 0), (0, 0, 0.2)),
    )
    commands, maps = Commands(gpu), ShadowMaps(gpu, "test", SIDE, 2)
    lights = [DirectionalLight((0.2, -1, 0.1), (1, 1, 1)), DirectionalLight((1, -1, 0), (1, 1, 1))]
    views = light_views(lights, np.full(3, -1.0), np.full(3, 1.0), SIDE)
    maps.encode(commands, GpuScene(gpu, Scene(meshes=meshes)), views)
    bounds = DepthBounds(gpu, maps)
    bounds.encode(commands)
    commands.submit()
    assert bounds.side == 64
    assert bounds.top == 3
    stored = bounds.buffer.read().view(np.uint32).reshape(2, 2 * 64 * 64)
    depth = maps.depth.read()
    texels = stored[:, 64 * 64 :].view(np.float32).reshape(2, 64, 64)
    np.testing.assert_array_equal(texels[:, :SIDE, :SIDE], depth)
    # Beyond the map nothing is bounded; what nothing covers has depth 1.
    low, high = np.ones((2, 64, 64), np.float32), np.zeros((2, 64, 64), np.float32)
    low[:, :SIDE, :SIDE] = high[:, :SIDE, :SIDE] = depth
    assert 0 < np.count_nonzero(depth < 1.0) < depth.size
    for level in range(1, 4):
        n = 64 >> level
        low = low.reshape(2, n, 2, n, 2).min(axis=(2, 4))
        high = high.reshape(2, n, 2, n, 2).max(axis=(2, 4))
        # A level of n^2 squares begins at entry n^2.
        words = stored[:, n * n : 2 * n * n].reshape(2, n, n)
        near, far = (words & 0xFFFF) / 65535.0, (words >> 16) / 65535.0
        # Rounded outwards, by little; what is wholly open stays so.
        assert np.all((near <= low) & (near > low - 1.1 / 65535.0))
        assert np.all((far >= high) & (far < high + 1.1 / 65535.0))
        np.testing.assert_array_equal(near == 1.0, low == 1.0)
