"""The blur averages a 4 x 4 pattern to its mean, and does not cross depth edges."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.media.rays import Rays
from airlight.media.shafts.blur import Blur
from airlight.scene import Camera, Mesh, Scene

SIZE = (32, 24)


def blurred(gpu: Gpu, seen: Any, values: np.ndarray) -> np.ndarray:
    rays = Rays(gpu, SIZE, 1)
    rays.encode(seen.commands, seen.view)
    raw = Texture(gpu, "raw", SIZE, "rgba32float")
    raw.write(np.repeat(values.astype(np.float32)[..., None], 4, axis=-1))
    out = Texture(gpu, "out", SIZE, "rgba32float", written=True)
    Blur(gpu).encode(seen.commands, rays, raw, out)
    return np.asarray(seen.read(out)[..., 0])


def test_a_pattern_becomes_its_mean(gpu: Gpu, look: Any) -> None:
    pattern = np.random.default_rng(2).random((4, 4))
    result = blurred(gpu, look(Scene(), SIZE), np.tile(pattern, (6, 8)))
    np.testing.assert_allclose(result[1:-2, 1:-2], pattern.mean(), rtol=1e-5)


def test_edges_stay(gpu: Gpu, look: Any, square: Callable[..., Mesh]) -> None:
    wall = square((0, 0, -6), (20, 0, 0), (0, 20, 0))
    post = square((-10, 0, -2), (10, 0, 0), (0, 20, 0))
    camera = Camera((0, 0, 0), (0.03, 0, -1), fov_y_deg=50)
    seen = look(Scene(meshes=(wall, post), camera=camera), SIZE)
    values = np.where(seen.directions()[..., 0] < 0.0, 1.0, 9.0)
    np.testing.assert_allclose(blurred(gpu, seen, values), values, rtol=1e-6)
