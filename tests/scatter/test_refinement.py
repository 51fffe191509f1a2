"""Whether the light far from its source and behind walls stays as it is while cells shrink."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import Camera, Material, Scene, SpotLight

from .rooms import sheet

LOW, HIGH = np.array([0.0, 0.0, 0.0]), np.array([12.0, 3.0, 12.0])
SETTINGS = {
    "gather": "off",
    "iterations": 120,
    "map_resolution": 64,
    "shadow_resolution": 256,
    "surfels": 200_000,
}

Walls = tuple[tuple[float, float, float], ...]
"""x of each wall across the hall, and from where to where along z it is open; metres."""
EMPTY: Walls = ()
ONE_WALL: Walls = ((4.05, 8.0, 12.0),)
TRUTH = {EMPTY: 165.1, ONE_WALL: 15.40}
"""The sum over the image's indirect light: `reference.render` of Mitsuba, 48 x 27, 4096 samples,
whose noise is 1e-3 of it at most."""


def hall(walls: Walls) -> Scene:
    """A spot in one corner of a hall of bright sheets, the eye in the other."""
    paint = Material(base_color=(0.75, 0.75, 0.75), specular=0.0)
    sheets = [
        sheet(axis, float(end[axis]), LOW, HIGH, paint) for axis in range(3) for end in (LOW, HIGH)
    ]
    for x, first, last in walls:
        closed = [(begin, end) for begin, end in ((0.0, first), (last, 12.0)) if begin < end]
        sheets += [sheet(0, x, (x, 0.0, begin), (x, 3.0, end), paint) for begin, end in closed]
    spot = SpotLight((2.0, 2.5, 2.0), (0.2, -1.0, 0.1), (60.0, 60.0, 60.0))
    camera = Camera((11.0, 1.5, 11.0), (9.0, 1.2, 1.0), fov_y_deg=70.0)
    return Scene(tuple(sheets), (spot,), camera=camera)


def indirect(walls: Walls, cells: int) -> float:
    """Of a frame with so many cells along the hall, over the truth."""
    settings = SETTINGS | {"resolution": cells}
    image = render(hall(walls), "lpv-scatter", (48, 27), samples=1, settings=settings)
    return float(image.layers["indirect"].sum()) / TRUTH[walls]


@pytest.mark.parametrize(("walls", "least"), [(EMPTY, 0.80), (ONE_WALL, 0.85)])
def test_the_far_end_of_a_hall_is_as_bright_with_cells_half_as_large(
    walls: Walls, least: float
) -> None:
    """Measured with 24, 32, 48 and 64 cells: .873, .856, .823, .824 without a wall, .944, .892,
    .917, .915 with one. With the same loss of direction on each hop the hall had .873, .829, .753
    and .944, .745, .542 with 24 to 48 cells.
    """
    coarse, fine = (indirect(walls, cells) for cells in (24, 48))
    assert min(coarse, fine) > least
    assert abs(np.log(fine / coarse)) < 0.1
