"""Computed normals and the merging of equal corners."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.io.normals import CREASE_COSINE, compact, creased_normals


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


def _by_definition(points, triangles):
    """Normals (T, 3, 3) of all corners: the mean of the faces around that bend little from its."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    normals = np.zeros((len(triangles), 3, 3))
    for t, k in np.ndindex(len(triangles), 3):
        for other, at in zip(*np.nonzero(triangles == triangles[t, k]), strict=True):
            if other == t or faces[t] @ faces[other] > CREASE_COSINE:
                here, ahead, behind = points[np.roll(triangles[other], -at)]
                u, v = ahead - here, behind - here
                cosine = u @ v / np.linalg.norm(u) / np.linalg.norm(v)
                normals[t, k] += faces[other] * np.arccos(np.clip(cosine, -1.0, 1.0))
    return normals / np.linalg.norm(normals, axis=2, keepdims=True)


@pytest.mark.parametrize("roughness", [0.05, 0.4, 1.0])
def test_it_is_the_mean_of_the_joined_faces(roughness):
    rng = np.random.default_rng(4)
    x, z = np.meshgrid(np.arange(8.0), np.arange(8.0))
    points = np.stack([x, roughness * rng.normal(size=x.shape), z], axis=-1).reshape(-1, 3)
    at = np.arange(64).reshape(8, 8)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[:-1, 1:], at[1:, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([c, b, d], 1)])
    table, index = creased_normals(points, triangles)
    np.testing.assert_allclose(table[index], _by_definition(points, triangles), atol=1e-9)


def test_compact_sorts_the_rows():
    corners = np.random.default_rng(2).integers(-1, 9, size=(40, 3, 2))
    rows, _ = compact(corners)
    np.testing.assert_array_equal(rows, np.unique(rows, axis=0))
