"""Holes closed by cones from their rims, and surfaces that face one way."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.closing import closed_surface, is_oriented, surface_area
from airlight.scene.shapes import box, sphere


def enclosed(points: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = np.moveaxis(points[faces], 1, 0)
    return abs(float(np.einsum("tk,tk->", a, np.cross(b, c)))) / 6.0


def test_a_closed_box_stays_as_it_is() -> None:
    shape = box()
    points, faces, holes = closed_surface(shape.positions.astype(float), shape.indices.astype(int))
    assert holes == 0 and len(faces) == 12 and is_oriented(points, faces)
    assert surface_area(points, faces) == pytest.approx(6.0, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_missing_of_a_box_is_closed_again(seed: int) -> None:
    """Plane holes get plane lids: the box has its volume, and faces out all over."""
    shape = box()
    side = np.arange(12) // 2
    gone = np.random.default_rng(seed).choice(6, 2, replace=False)
    kept = shape.indices[~np.isin(side, gone)].astype(int)
    points, faces, holes = closed_surface(shape.positions.astype(float), kept)
    # Holes of opposite sides are two, of sides with a common edge one that is not plane.
    is_opposite = abs(np.dot(shape.normals[4 * gone[0]], shape.normals[4 * gone[1]])) > 0.5
    assert holes == (2 if is_opposite else 1)
    assert is_oriented(points, faces)
    if is_opposite:
        assert enclosed(points, faces) == pytest.approx(1.0, rel=1e-5)


def test_a_seam_that_nearly_meets_is_none() -> None:
    shape = sphere(24, 12)
    points = shape.positions.astype(float)
    points += np.random.default_rng(1).normal(size=points.shape) * 1e-9
    made, faces, holes = closed_surface(points, shape.indices.astype(int))
    assert holes == 0 and is_oriented(made, faces)
    flipped = faces.copy()
    flipped[5] = flipped[5, ::-1]
    assert not is_oriented(made, flipped)
    assert closed_surface(made, flipped)[2] == 0
