"""Surfaces of zeros: on the field's zeros, closed, facing out, of the right area."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.level_set import gradient_at, refined, zero_surface
from airlight.maths.voxels import trilinear
from airlight.maths.weld import open_vertices


def grid(nz, ny, nx):
    return np.meshgrid(np.arange(nz), np.arange(ny), np.arange(nx), indexing="ij")


def ball(radius=6.3, size=(17, 17, 17)):
    z, y, x = grid(*size)
    return np.sqrt((x - 8) ** 2 + (y - 8) ** 2 + (z - 8) ** 2) - radius


def normals_and_areas(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    return normal / area[:, None], area / 2.0


@pytest.mark.parametrize("field", [ball(), -ball(), ball(2.6)])
def test_a_ball_is_closed_and_faces_the_positive_side(field):
    points, triangles = zero_surface(field)
    assert not open_vertices(triangles).any()
    normal, _ = normals_and_areas(points, triangles)
    middle = points[triangles].mean(axis=1) - 8.0
    outwards = np.einsum("ij,ij->i", normal, middle) / np.linalg.norm(middle, axis=1)
    assert (outwards * np.sign(field[0, 0, 0])).min() > 0.7


def test_finer_cells_come_to_the_ball_s_area_and_to_the_trilinear_zero():
    """A ball of a field that is a quadratic has its zeros moved by the trilinear field alone."""
    field = ball()
    for parts, most in ((1, 0.02), (3, 0.007)):
        points, triangles = zero_surface(refined(field, parts))
        _, area = normals_and_areas(points / parts, triangles)
        assert area.sum() == pytest.approx(4 * np.pi * 6.3**2, rel=most)
        left = trilinear(field, points / parts + 0.5)
        assert np.abs(left).max() < 0.05 / parts**2


def test_a_plane_is_exact_on_a_grid_of_any_shape():
    z, y, x = grid(4, 6, 9)
    field = 0.3 * x + 0.5 * y - 0.7 * z - 1.1
    points, triangles = zero_surface(field)
    np.testing.assert_allclose(points @ (0.3, 0.5, -0.7), 1.1, atol=1e-12)
    normal, _ = normals_and_areas(points, triangles)
    expected = np.array((0.3, 0.5, -0.7)) / np.linalg.norm((0.3, 0.5, -0.7))
    np.testing.assert_allclose(normal, np.tile(expected, (len(normal), 1)), atol=1e-9)
    np.testing.assert_allclose(
        gradient_at(field, points), np.tile((0.3, 0.5, -0.7), (len(points), 1))
    )


@pytest.mark.parametrize("value", [1.0, -1.0, 0.0])
def test_one_sign_has_no_surface(value):
    points, triangles = zero_surface(np.full((3, 3, 3), value))
    assert len(triangles) == 0
    assert points.shape == (0, 3)
