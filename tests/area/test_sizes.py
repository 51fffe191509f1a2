"""What parts of lights are as large as: rectangles turned as they are, balls."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.area.pieces import Pieces
from airlight.area.segments import long_part
from airlight.area.sizes import body, rectangle
from airlight.scene.shapes import sphere


def pieces(corners: np.ndarray) -> Pieces:
    """Triangles (n, 3, 3) as pieces that glow alike."""
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = 0.5 * np.linalg.norm(crosses, axis=1)
    normals = crosses / (2.0 * areas[:, None])
    return Pieces(corners.mean(axis=1), normals, areas, np.ones((len(corners), 3)), corners)


def turned(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of the plane z = 0 somewhere else, and the three axes there."""
    axes = np.linalg.qr(np.array([[1.0, 2.0, 0.3], [-0.5, 1.0, 1.1], [0.7, -0.4, 2.0]]))[0]
    axes *= np.sign(np.linalg.det(axes))
    return points @ axes.T + (3.0, -2.0, 5.0), axes


def test_a_panel_is_its_own_rectangle():
    flat = np.array([(-2, -0.5, 0), (2, -0.5, 0), (2, 0.5, 0), (-2, 0.5, 0)], np.float64)
    placed, axes = turned(flat)
    found = pieces(placed[[[0, 1, 2], [0, 2, 3]]])
    size = rectangle(found, axes[:, 2])
    assert size.extent == pytest.approx((2.0, 0.5))
    assert abs(size.tangent @ axes[:, 0]) == pytest.approx(1.0)


def test_a_disk_is_a_square_of_its_area():
    angle = np.arange(65) / 64 * 2.0 * np.pi
    rim, _ = turned(np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1))
    middle, axes = turned(np.zeros((1, 3)))
    fan = np.stack([np.broadcast_to(middle, (64, 3)), rim[:-1], rim[1:]], axis=1)
    wide, narrow = rectangle(pieces(fan), axes[:, 2]).extent
    assert wide == pytest.approx(narrow)
    assert 4.0 * wide * narrow == pytest.approx(pieces(fan).areas.sum())


def test_a_ball_is_one_and_a_tube_is_none():
    geometry = sphere()
    found = pieces(0.6 * geometry.positions.astype(np.float64)[geometry.indices])
    assert body(found, None).extent == pytest.approx((0.3, 0.0), rel=2e-3)
    tube = pieces(found.corners * (1.0, 5.0, 1.0))
    assert body(tube, long_part(tube)).extent == (0.0, 0.0)
