"""Meshes: smooth normals from area, bounds from corners, bad triangles refused."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Geometry, Mesh
from airlight.scene.mesh import smooth_normals
from airlight.scene.shapes import box

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
ONE = np.array([[0, 1, 2]], np.uint32)


def test_missing_normals_point_to_the_front():
    geometry = Geometry(TRIANGLE, ONE)
    np.testing.assert_allclose(geometry.normals, np.tile([0, 0, 1], (3, 1)))
    assert geometry.normals.dtype == np.float32


def test_smooth_normals_weigh_triangles_by_area():
    # At the shared corner: area 2 facing +Z and area 1/2 facing +X.
    positions = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    indices = np.array([[0, 1, 2], [0, 3, 4]], np.uint32)
    expected = np.array([0.5, 0.0, 2.0]) / np.hypot(0.5, 2.0)
    np.testing.assert_allclose(smooth_normals(positions, indices)[0], expected, atol=1e-6)


def test_a_vertex_of_no_area_gets_up():
    positions = np.vstack([TRIANGLE, [[9, 9, 9]]]).astype(np.float32)
    np.testing.assert_array_equal(smooth_normals(positions, ONE)[3], [0, 1, 0])


def test_world_bounds_follow_the_transform():
    matrix = np.eye(4)
    half = np.sqrt(0.5)
    matrix[:3, :3] = [
        [half, 0, half],
        [0, 2, 0],
        [-half, 0, half],
    ]  # an eighth of a turn, twice as tall
    matrix[:3, 3] = [10, 0, 0]
    low, high = Mesh(box(), world_from_object=matrix).world_bounds
    np.testing.assert_allclose(low, [10 - half, -1, -half], atol=1e-12)
    np.testing.assert_allclose(high, [10 + half, 1, half], atol=1e-12)


def test_unused_vertices_do_not_widen_the_bounds():
    positions = np.vstack([TRIANGLE, [[99, 99, 99]]]).astype(np.float32)
    _, high = Mesh(Geometry(positions, ONE)).world_bounds
    np.testing.assert_array_equal(high, [1, 1, 0])


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"indices": ONE[:0]}, "mesh has no triangles"),
        ({"indices": np.array([[0, 1, 3]])}, "triangle index 3 is out of range: the mesh has 3"),
        ({"indices": np.array([[0, -1, 2]])}, "triangle index -1 is out of range"),
        ({"indices": np.array([0, 1, 2])}, r"indices has shape \(3,\), it must be \(n, 3\)"),
        ({"positions": TRIANGLE * np.nan}, "vertex positions has 9 values that are NaN"),
        ({"positions": TRIANGLE[:, :2]}, r"vertex positions has shape \(3, 2\)"),
        ({"uvs": TRIANGLE}, r"uvs has shape \(3, 3\), it must be \(3, 2\)"),
        ({"colors": TRIANGLE}, r"colors has shape \(3, 3\), it must be \(3, 4\)"),
    ],
)
def test_broken_geometry_is_refused(values, expected):
    with pytest.raises(SceneError, match=expected):
        Geometry(**{"positions": TRIANGLE, "indices": ONE, **values})


def test_a_transform_must_be_a_finite_4_by_4():
    with pytest.raises(SceneError, match=r"transform of mesh 'lamp' has shape \(3, 3\)"):
        Mesh(box(), world_from_object=np.eye(3), name="lamp")


def test_a_transform_must_be_affine():
    matrix = np.diag((1.0, 1.0, 1.0, 0.0))
    with pytest.raises(SceneError, match="is not affine: its last row is 0, 0, 0, 0, not 0"):
        Mesh(box(), world_from_object=matrix)
