"""Closed meshes as voxels: boxes exactly, balls by their volume, unions of overlaps."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.solid_voxels import solid_voxels
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
        ball.positions * 1.6, ball.indices[:, ::-1].astype(np.int64), LOW, HIGH, (24, 24, 24)
    )
    np.testing.assert_allclose(flipped, got)


def test_overlaps_count_once():
    cube = box()
    twice = np.concatenate([cube.positions, cube.positions]).astype(float)
    triangles = np.concatenate([cube.indices, cube.indices + len(cube.positions)]).astype(np.int64)
    got = solid_voxels(twice, triangles, LOW, HIGH, (10, 10, 10))
    assert got.max() == 1.0
    np.testing.assert_allclose(got, voxels(cube, 1.0, count=(10, 10, 10)))
