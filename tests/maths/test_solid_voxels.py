"""Closed meshes as voxels: boxes exactly, balls by their volume, unions of overlaps."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.solid_voxels import soft_rim, solid_voxels
from airlight.scene.shapes import box, sphere

LOW, HIGH = np.array([-1.0, -1.0, -1.0]), np.array([1.0, 1.0, 1.0])


def voxels(shape, scale, move=(0.0, 0.0, 0.0), count=(10, 12, 14)):
    at = shape.positions.astype(float) * scale + move
    return solid_voxels(at, shape.indices.astype(np.int64), LOW, HIGH, count)


def test_a_box_fills_its_voxels():
    got = voxels(box(), 1.0, (0.1, 0.0, 0.0))  # 0.5 m around (0.1, 0, 0)
    assert got.shape == (14, 12, 10)
    assert got.sum() * (2 / 10) * (2 / 12) * (2 / 14) == pytest.approx(1.0, rel=0.02)
    assert got[7, 6].tolist() == pytest.approx([0, 0, 0, 1, 1, 1, 1, 1, 0, 0])


def test_a_ball_has_its_volume_whichever_way_it_faces():
    ball = sphere()
    got = voxels(ball, 1.6, count=(24, 24, 24))
    assert got.mean() * 8 == pytest.approx(np.pi / 6 * 1.6**3, rel=0.02)
    flipped = solid_voxels(
        ball.positions.astype(float) * 1.6,
        ball.indices[:, ::-1].astype(np.int64),
        LOW,
        HIGH,
        (24, 24, 24),
    )
    np.testing.assert_allclose(flipped, got)


def test_overlaps_count_once():
    cube = box()
    twice = np.concatenate([cube.positions, cube.positions]).astype(float)
    triangles = np.concatenate([cube.indices, cube.indices + len(cube.positions)]).astype(np.int64)
    got = solid_voxels(twice, triangles, LOW, HIGH, (10, 10, 10))
    assert got.max() == 1.0
    np.testing.assert_allclose(got, voxels(cube, 1.0, count=(10, 10, 10)))


def _outline(density: np.ndarray, n: int) -> np.ndarray:
    """Along z through trilinear density, the height that half of the light ends at, by column x."""
    x = np.linspace(0.3, 0.7, 101)
    y = np.linspace(0.55, 0.95, 401)
    z = (np.arange(4 * n) + 0.5) / (4 * n)
    at = np.stack(np.meshgrid(z, y, x, indexing="ij"), axis=-1) * n - 0.5
    low = np.clip(np.floor(at).astype(int), 0, n - 2)
    f = at - low
    depth = np.zeros(at.shape[1:3])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, f, 1 - f), axis=-1)
        depth += (weight * density[tuple(np.moveaxis(low + corner, -1, 0))]).sum(axis=0)
    # As dense as builtin:milk was when its outline had teeth: 1.3 a voxel.
    opaque = np.exp(-1.3 * depth / 4) < 0.5
    return y[len(y) - 1 - np.argmax(opaque[::-1], axis=0)]


def test_a_soft_rim_has_no_teeth() -> None:
    """The outline of a dense ball is smoother than that of shares of voxels, and holds as much."""
    n = 24
    mid = (np.arange(4 * n) + 0.5) / (4 * n) - 0.5
    inside = (mid[:, None, None] ** 2 + mid[:, None] ** 2 + mid**2) < 0.35**2
    shares = inside.reshape(n, 4, n, 4, n, 4).mean(axis=(1, 3, 5))
    soft = soft_rim(shares)
    assert soft.sum() == pytest.approx(shares.sum())
    assert soft.max() == 1.0

    def teeth(density: np.ndarray) -> float:
        """How far the outline lies from its mean over two voxels, in voxels of height."""
        x = np.linspace(0.3, 0.7, 101) - 0.5
        rest = np.hypot(x, _outline(density, n) - 0.5)
        smooth = np.convolve(rest, np.full(21, 1 / 21), "valid")
        return float((rest[10:-10] - smooth).std() * n)

    # Measured .066 and .027.
    assert teeth(soft) < 0.5 * teeth(shares)
