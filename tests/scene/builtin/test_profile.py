"""Swept surfaces against the areas that geometry books give."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import Geometry
from airlight.scene.builtin.profile import (
    along_x,
    arc,
    around_arch,
    around_rectangle,
    profile,
    revolved,
)


def area(geometry: Geometry) -> float:
    p = geometry.positions[geometry.indices].astype(np.float64)
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    return float(np.linalg.norm(cross, axis=1).sum() / 2)


def test_a_sharp_corner_has_two_normals_and_a_smooth_one_only_one() -> None:
    sharp = profile([(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    assert np.allclose(sharp.normals, [(1, 0), (1, 0), (0, 1), (0, 1)])
    smooth = profile(arc((0.0, 0.0), 2.0, -90.0, 90.0, 12))
    assert np.allclose(smooth.normals[1:-1:2], smooth.normals[2::2])
    assert np.allclose(smooth.normals[1], smooth.points[1] / 2.0)
    assert smooth.lengths[-1] == pytest.approx(2.0 * np.pi, rel=0.005)


def test_repeated_points_are_dropped() -> None:
    assert len(profile([(0, 0), (0, 1), (0, 1), (0, 2)]).segments) == 2


def test_sphere_and_cone_and_their_normals() -> None:
    ball = revolved(profile(arc((0.0, 0.0), 1.5, -90.0, 90.0, 64)), 128)
    assert area(ball) == pytest.approx(4 * np.pi * 1.5**2, rel=2e-3)
    assert np.allclose(ball.normals, ball.positions / 1.5, atol=0.03)
    cone = revolved(profile([(1.0, 0.0), (0.0, 2.0)]), 256)
    assert area(cone) == pytest.approx(np.pi * np.sqrt(5.0), rel=1e-3)


def test_block_and_court() -> None:
    wall = profile([(0.0, 0.0), (0.0, 3.0)])
    block, court = (around_rectangle(wall, 2.0, 1.0, inwards=inside) for inside in (False, True))
    for geometry, sign in ((block, 1.0), (court, -1.0)):
        assert area(geometry) == pytest.approx(12.0 * 3.0)
        outwards = np.einsum("ij,ij->i", geometry.positions[:, [0, 2]], geometry.normals[:, [0, 2]])
        assert np.all(sign * outwards > 0.0)


def test_mitred_moulding_has_no_gap() -> None:
    """Corner points of neighbouring sides coincide: every one occurs at least twice."""
    ring = around_rectangle(profile([(0.0, 0.0), (0.3, 0.2), (0.1, 0.5)]), 2.0, 1.0, inwards=True)
    assert np.abs(ring.positions[:, 0]).min() == pytest.approx(1.7)
    points, counts = np.unique(ring.positions.round(5), axis=0, return_counts=True)
    assert len(points) == 12 and counts.min() >= 2


def test_half_ring_and_rail() -> None:
    ring = around_arch(profile([(0.5, 0.0), (0.0, 0.0)]), 2.0, 200)
    assert area(ring) == pytest.approx(np.pi / 2 * (2.5**2 - 2.0**2), rel=1e-3)
    assert np.allclose(ring.normals, (0, 0, 1))
    rail = along_x(profile([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]), -1.0, 2.0)
    assert area(rail) == pytest.approx(12.0)
    middle = rail.positions[:, 1:] - 0.5
    assert np.all(np.einsum("ij,ij->i", middle, rail.normals[:, 1:]) > 0.0)
