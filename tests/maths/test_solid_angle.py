"""Solid angles and mean directions against known solids and quadrature."""

import numpy as np
from scipy.integrate import dblquad

from airlight.maths.solid_angle import (
    polygon_mean_direction,
    polygon_solid_angle,
    quad_mean_square,
    triangle_solid_angle,
    voronoi_cell,
)


def test_octant_is_an_eighth_of_the_sphere() -> None:
    np.testing.assert_allclose(triangle_solid_angle(np.eye(3)), np.pi / 2.0)
    # the mean direction over an octant: each axis projects to a quarter disc of area pi/4
    np.testing.assert_allclose(polygon_mean_direction(np.eye(3)), 0.5)


def test_rectangle_against_quadrature() -> None:
    corners = np.array([[-0.3, 0.2, 1.5], [0.9, 0.2, 1.5], [0.9, 1.1, 1.5], [-0.3, 1.1, 1.5]])

    def over(f):  # type: ignore[no-untyped-def]
        value, _ = dblquad(
            lambda y, x: f(x, y) * 1.5 / (x * x + y * y + 2.25) ** 1.5, -0.3, 0.9, 0.2, 1.1
        )
        return value

    omega = over(lambda x, y: 1.0)
    np.testing.assert_allclose(polygon_solid_angle(corners), omega, rtol=1e-10)
    mean = [
        over(lambda x, y, k=k: (x, y, 1.5)[k] / np.hypot(np.hypot(x, y), 1.5)) for k in (0, 1, 2)
    ]
    np.testing.assert_allclose(polygon_mean_direction(corners), np.array(mean) / omega, rtol=1e-10)
    np.testing.assert_allclose(
        polygon_mean_direction(corners[::-1]), np.array(mean) / omega, rtol=1e-10
    )


def test_outer_squares_over_a_cube_add_up_to_those_of_the_sphere() -> None:
    square = np.array([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float)
    top = quad_mean_square(square)
    np.testing.assert_allclose(np.trace(top), 1.0)
    # Three pairs of faces, 4 pi/3 each; over the sphere the mean is a third of the identity.
    turned = [np.roll(np.roll(top, k, axis=0), k, axis=1) for k in range(3)]
    np.testing.assert_allclose(sum(turned) / 3.0, np.eye(3) / 3.0, atol=1e-12)


def test_voronoi_cells_of_the_cube_and_octahedron_directions() -> None:
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    for k in range(6):
        cell = voronoi_cell(axes, k)
        assert len(cell) == 4
        np.testing.assert_allclose(polygon_solid_angle(cell), 4.0 * np.pi / 6.0)


def test_voronoi_cells_tile_the_sphere() -> None:
    d = np.random.default_rng(3).normal(size=(40, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    total = sum(float(polygon_solid_angle(voronoi_cell(d, k))) for k in range(40))
    np.testing.assert_allclose(total, 4.0 * np.pi, rtol=1e-9)
