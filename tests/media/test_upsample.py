"""Upsampling keeps depth edges sharp, and is bilinear on one surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.media.compositing.upsample import Upsample
from airlight.media.rays import Rays
from airlight.scene import Camera, Mesh, Scene

SIZE = (40, 24)
CAMERA = Camera((0, 0, 0), (0.03, 0, -1), fov_y_deg=70)


def upsampled(gpu: Gpu, seen: Any, scale: int, values: Callable[..., np.ndarray]) -> np.ndarray:
    """`values` (picked distance, reduced x) -> the image at full size, one channel."""
    rays = Rays(gpu, SIZE, scale)
    rays.encode(seen.commands, seen.view)
    distance = seen.read(rays.picked)[..., 0]
    texels = np.ones((*distance.shape, 4), np.float32)
    texels[..., :3] = values(distance, np.indices(distance.shape)[1])[..., None]
    reduced = Texture(gpu, "reduced", rays.reduced, "rgba32float")
    reduced.write(texels)
    target = Texture(gpu, "full", SIZE, "rgba32float", target=True, written=True)
    Upsample(gpu).encode(seen.commands, rays, seen.view.gbuffer.depth, reduced, target)
    return np.asarray(seen.read(target)[..., 0])


@pytest.mark.parametrize("scale", [2, 4])
def test_a_depth_edge_stays_sharp(
    gpu: Gpu, look: Any, square: Callable[..., Mesh], scale: int
) -> None:
    wall = square((0, 0, -6), (20, 0, 0), (0, 20, 0))
    post = square((-10, 0, -2), (10, 0, 0), (0, 20, 0))
    seen = look(Scene(meshes=(wall, post), camera=CAMERA), SIZE)
    full = upsampled(gpu, seen, scale, lambda distance, _: np.where(distance < 4.0, 1.0, 9.0))
    d = seen.directions()
    expected = np.where(d[..., 0] < 0.0, 1.0, 9.0)
    np.testing.assert_allclose(full, expected, rtol=0.03)


@pytest.mark.parametrize("scale", [2, 4])
def test_one_surface_is_bilinear(
    gpu: Gpu, look: Any, square: Callable[..., Mesh], scale: int
) -> None:
    """A ramp along x comes out as it went in: each texel counts where its ray goes."""
    wall = square((0, 0, -6), (40, 0, 0), (0, 40, 0))
    seen = look(Scene(meshes=(wall,), camera=Camera((0, 0, 0), (0, 0, -1), fov_y_deg=40)), SIZE)
    # Texels take the ray of the middle pixel of their blocks.
    full = upsampled(gpu, seen, scale, lambda _, x: scale * x + scale // 2 + 0.5)
    expected = np.broadcast_to(np.arange(SIZE[0]) + 0.5, (SIZE[1], SIZE[0]))
    edge = 2 * scale
    np.testing.assert_allclose(full[:, edge:-edge], expected[:, edge:-edge], atol=0.05 * scale)
