"""Shapes: unit sized, watertight, outward, with upright images on them."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.mesh import Geometry
from airlight.scene.shapes import box, quad, revolved, sphere


def corners(geometry: Geometry) -> np.ndarray:
    """(T, 3, 3) float64 corner positions."""
    return geometry.positions[geometry.indices].astype(np.float64)


def signed_volume(geometry: Geometry) -> float:
    """Volume by the divergence theorem: positive only where triangles face outwards."""
    a, b, c = np.moveaxis(corners(geometry), 1, 0)
    return float(np.einsum("tx,tx->", a, np.cross(b, c)) / 6.0)


def area(geometry: Geometry) -> float:
    a, b, c = np.moveaxis(corners(geometry), 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def test_box_is_a_unit_cube_facing_out():
    geometry = box()
    assert geometry.positions.shape == (24, 3)
    assert geometry.indices.shape == (12, 3)
    assert geometry.positions.min() == -0.5
    assert geometry.positions.max() == 0.5
    assert signed_volume(geometry) == pytest.approx(1.0, abs=1e-12)
    assert area(geometry) == pytest.approx(6.0, abs=1e-12)


def test_quad_faces_up():
    geometry = quad()
    assert area(geometry) == pytest.approx(1.0)
    np.testing.assert_array_equal(geometry.normals, np.tile([0.0, 1.0, 0.0], (4, 1)))
    assert np.all(geometry.positions[:, 1] == 0.0)


def test_sphere_has_the_inscribed_polyhedron_volume_and_area():
    # An inscribed sphere of n segments loses a factor (n/2pi) sin(2pi/n) to second order.
    geometry = sphere(64, 32)
    assert signed_volume(geometry) == pytest.approx(np.pi / 6.0, rel=5e-3)
    assert area(geometry) == pytest.approx(np.pi, rel=5e-3)
    radii = np.linalg.norm(geometry.positions, axis=1)
    np.testing.assert_allclose(radii, 0.5, atol=1e-7)


def test_sphere_is_watertight():
    """Every directed edge has its opposite once vertices of the very same position are merged."""
    geometry = sphere(12, 7)
    own, merged = np.unique(geometry.positions, axis=0, return_inverse=True)
    assert len(own) == 12 * (7 - 1) + 2
    # An image still ends at the seam and begins there again.
    seam = (geometry.positions == geometry.positions[3 * 13]).all(axis=1)
    assert geometry.uvs[seam].tolist() == [
        [0.0, geometry.uvs[3 * 13, 1]],
        [1.0, geometry.uvs[3 * 13, 1]],
    ]
    triangles = merged.reshape(-1)[geometry.indices]
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    assert sorted(map(tuple, edges)) == sorted(map(tuple, edges[:, ::-1]))
    assert len(triangles) == 2 * 12 * (7 - 1)


@pytest.mark.parametrize("make", [box, quad, sphere])
def test_normals_agree_with_the_winding(make):
    geometry = make()
    a, b, c = np.moveaxis(corners(geometry), 1, 0)
    face = np.cross(b - a, c - a)
    mean = geometry.normals[geometry.indices].mean(axis=1)
    assert np.all(np.einsum("tx,tx->t", face, mean) > 0.0)
    np.testing.assert_allclose(np.linalg.norm(geometry.normals, axis=1), 1.0, atol=1e-6)


@pytest.mark.parametrize("make", [box, quad, sphere])
def test_images_are_not_mirrored(make):
    """v runs down: seen from outside, the uv triangle turns clockwise in (u, -v) nowhere."""
    geometry = make()
    a, b, c = np.moveaxis(geometry.uvs[geometry.indices].astype(np.float64), 1, 0)
    (bu, bv), (cu, cv) = (b - a).T, (c - a).T
    assert np.all(bu * -cv + bv * cu > 0.0)


def test_images_stand_upright_on_walls():
    """The image's top row (v = 0) is at the top of the four walls of a box, and of a sphere."""
    geometry = box()
    walls = np.abs(geometry.normals[:, 1]) < 0.5
    np.testing.assert_array_equal(
        geometry.uvs[walls, 1] == 0.0, geometry.positions[walls, 1] == 0.5
    )
    ball = sphere()
    np.testing.assert_allclose(ball.positions[ball.uvs[:, 1] == 0.0, 1], 0.5)


def test_a_body_of_revolution_is_closed_and_faces_out():
    """Two cones of radius 2, together 3 high."""
    points = np.array([(0.0, -1.0), (2.0, 0.5), (0.0, 2.0)])
    lines = []
    for start, end in ((0, 1), (1, 2)):
        along = points[end] - points[start]
        normal = np.array([along[1], -along[0]]) / np.linalg.norm(along)
        lines.append((points[[start, end]], np.stack([normal, normal])))
    count = 48
    geometry = revolved(lines, count)
    # Of a pyramid on a regular polygon.
    polygon = 0.5 * count * 4.0 * np.sin(2.0 * np.pi / count)
    assert signed_volume(geometry) == pytest.approx(polygon * 3.0 / 3.0, rel=1e-6)
    a, b, c = np.moveaxis(corners(geometry), 1, 0)
    faces = np.cross(b - a, c - a)
    assert (np.linalg.norm(faces, axis=1) > 1e-9).all()
    shading = geometry.normals[geometry.indices].astype(np.float64)
    assert (np.einsum("tx,tkx->tk", faces, shading) > 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(geometry.normals, axis=1), 1.0, rtol=1e-6)
