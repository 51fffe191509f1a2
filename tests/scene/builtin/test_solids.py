"""Boxes: volume by the divergence theorem, faces, texture coordinates in metres."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import Geometry
from airlight.scene.builtin.solids import box, rectangle, rounded_box


def volume(geometry: Geometry) -> float:
    """Signed: positive where the triangles face outwards."""
    p = geometry.positions[geometry.indices].astype(np.float64)
    return float(np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6)


def test_box() -> None:
    solid = box((1.0, 2.0, 3.0), (2.0, 4.0, 6.0))
    assert len(solid.indices) == 12
    assert volume(solid) == pytest.approx(6.0)
    assert len(box((0, 0, 0), (1, 1, 1), ("+y", "-x")).indices) == 4


def test_rounded_box_is_closed_and_a_little_smaller() -> None:
    solid = rounded_box((0.0, 0.0, 0.0), (1.0, 0.5, 2.0), 0.1)
    assert len(solid.indices) == 108
    assert 0.95 < volume(solid) < 1.0
    edges = np.sort(solid.positions[solid.indices].round(5), axis=None).size
    assert edges == 108 * 9
    assert np.all(solid.positions.min(axis=0) == (0, 0, 0))
    assert np.allclose(solid.positions.max(axis=0), (1.0, 0.5, 2.0))


def test_rounded_box_accepts_too_large_a_radius() -> None:
    assert volume(rounded_box((0, 0, 0), (1, 1, 0.01), 0.5)) > 0.0


def test_rectangle_faces_down_cross_right_and_measures_metres() -> None:
    floor = rectangle((-2.0, 1.0, -3.0), (4.0, 0.0, 0.0), (0.0, 0.0, 6.0), cells=(2, 3))
    assert len(floor.indices) == 12
    assert np.allclose(floor.normals, (0, 1, 0))
    assert np.allclose(np.ptp(floor.uvs, axis=0), (4.0, 6.0))
