"""Texels stand for one pixel of their block; at edges both sides are kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.media.rays import Rays
from airlight.scene import Camera, Mesh, Scene

SIZE = (22, 14)
WALL_Z, POST_Z = -6.0, -2.0


@pytest.fixture
def posts(square: Callable[..., Mesh]) -> Scene:
    """A wall, and before its left half a sheet."""
    wall = square((0, 0, WALL_Z), (20, 0, 0), (0, 20, 0))
    post = square((-10, 0, POST_Z), (10, 0, 0), (0, 20, 0))
    return Scene(meshes=(wall, post), camera=Camera((0, 0, 0), (0.03, 0, -1), fov_y_deg=70))


def true_distance(seen: Any) -> np.ndarray:
    d = seen.directions()
    near = POST_Z / d[..., 2]
    return np.where(d[..., 0] * near < 0.0, near, WALL_Z / d[..., 2])


@pytest.mark.parametrize("scale", [1, 2, 4])
def test_a_texel_is_one_of_its_pixels(gpu: Gpu, look: Any, posts: Scene, scale: int) -> None:
    seen = look(posts, SIZE)
    rays = Rays(gpu, SIZE, scale)
    rays.encode(seen.commands, seen.view)
    picked = seen.read(rays.picked)
    distance, index = picked[..., 0], picked[..., 1].astype(int)
    y, x = np.indices(distance.shape)
    pixel = y * scale + index // scale, x * scale + index % scale
    # Devices may contract sums, and divide with 2.5 units in the last place: 4.2e-6 on an H100.
    np.testing.assert_allclose(distance, true_distance(seen)[pixel], rtol=1e-5)
    assert distance.shape == (-(-SIZE[1] // scale), -(-SIZE[0] // scale))


def test_edges_keep_both_sides(gpu: Gpu, look: Any, posts: Scene) -> None:
    seen = look(posts, SIZE)
    rays = Rays(gpu, SIZE, 4)
    rays.encode(seen.commands, seen.view)
    distance = seen.read(rays.picked)[..., 0]
    true = true_distance(seen)
    column = int(
        np.argmax(np.ptp(true[:12].reshape(3, 4, -1)[0, :, :20].reshape(4, 5, 4), axis=(0, 2)))
    )
    near = distance[:3, column] < 4.0
    assert near.any()
    assert not near.all()


def test_nothing_is_far_away(gpu: Gpu, look: Any) -> None:
    seen = look(Scene(), SIZE)
    rays = Rays(gpu, SIZE, 2)
    rays.encode(seen.commands, seen.view)
    assert np.all(seen.read(rays.picked)[..., 0] == 1e9)
