"""Vertices that tell triangles apart."""

from __future__ import annotations

import numpy as np

from airlight.surface.provoking import unique_provoking


def _grid(side):
    """Indices of a grid of side x side squares, two triangles each."""
    row, column = np.mgrid[0:side, 0:side].reshape(2, -1)
    a = row * (side + 1) + column
    b, c, d = a + 1, a + side + 1, a + side + 2
    return np.stack([a, c, b, b, c, d], axis=1).reshape(-1, 3).astype(np.uint32)


def test_each_triangle_begins_at_a_vertex_of_its_own_and_stays_where_it_was():
    for indices in (_grid(9), np.random.default_rng(3).integers(0, 40, (100, 3), np.uint32)):
        sources, corners = unique_provoking(indices)
        np.testing.assert_array_equal(corners[:, 0], np.arange(len(indices)))
        np.testing.assert_array_equal(sources[corners], indices)
        assert corners.max() == len(sources) - 1


def test_vertices_that_begin_no_triangle_are_there_once():
    sources, corners = unique_provoking(np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    np.testing.assert_array_equal(sources, [0, 0, 1, 2, 3])
    np.testing.assert_array_equal(corners, [[0, 2, 3], [1, 3, 4]])


def test_corners_are_copies_near_by():
    """Of 1024 indices in a row few vertices are others than the triangles' own."""
    _, corners = unique_provoking(_grid(40))
    for begin in range(0, len(corners) - 341, 341):
        run = corners[begin : begin + 341]
        assert len(np.unique(run)) < 1.4 * len(run)
