"""Computed normals and the merging of equal corners."""

from __future__ import annotations

import numpy as np

from airlight.scene.io.normals import compact, creased_normals


def test_a_gentle_bend_is_smooth_and_a_right_angle_is_sharp():
    for bend_deg, is_smooth in ((30.0, True), (90.0, False)):
        angle = np.radians(bend_deg)
        points = np.array(
            [(0, 0, 0), (0, 0, 1), (-1, 0, 0), (np.cos(angle), -np.sin(angle), 0)], dtype=float
        )
        triangles = np.array([(0, 2, 1), (0, 1, 3)])
        table, index = creased_normals(points, triangles)
        shared = index[0, 0] == index[1, 0]
        assert shared == is_smooth
        np.testing.assert_allclose(np.linalg.norm(table, axis=1), 1, atol=1e-6)


def test_a_sliver_without_area_does_no_harm():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 0, -1), (2, 0, 0)], dtype=float)
    table, index = creased_normals(points, np.array([(0, 1, 2), (0, 1, 3)]))
    np.testing.assert_allclose(table[index[1]], [[0, 1, 0]] * 3)


def test_compact_is_the_inverse_of_indexing():
    corners = np.random.default_rng(1).integers(-1, 4, size=(60, 3, 3))
    rows, indices = compact(corners)
    np.testing.assert_array_equal(rows[indices], corners)
    assert len(np.unique(rows, axis=0)) == len(rows)


def test_compact_where_a_single_key_would_overflow():
    corners = np.array([[[0, 2**40, 5], [2**40, 0, 2**40], [0, 2**40, 5]]])
    rows, indices = compact(corners)
    np.testing.assert_array_equal(rows[indices], corners)
    assert len(rows) == 2
