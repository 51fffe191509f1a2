"""The closed body of the atrium: floors, outer walls, roof, string course and cornice.

The court's clear opening is 18.6 x 6.6 m, the outer walls stand 28 x 16 m apart.
"""

from __future__ import annotations

from ..mesh import Geometry
from .arcade import GALLERY_M, STOREY_M, WALL_HALF_M
from .patch import merged, moved, placed_at
from .profile import Points, arc, around_rectangle, profile
from .solids import box, rectangle

AXIS_X_M, AXIS_Z_M = 9.6, 3.6
"""Half distances between opposite arcades' axes: eight and three bays."""

COURT_X_M, COURT_Z_M = AXIS_X_M - WALL_HALF_M, AXIS_Z_M - WALL_HALF_M
INNER_X_M, INNER_Z_M = AXIS_X_M + WALL_HALF_M + GALLERY_M, AXIS_Z_M + WALL_HALF_M + GALLERY_M
OUTER_WALL_M = 0.5
OUTER_X_M, OUTER_Z_M = INNER_X_M + OUTER_WALL_M, INNER_Z_M + OUTER_WALL_M
ROOF_M = 2.0 * STOREY_M
PARAPET_M = ROOF_M + 1.0
"""Heights above the ground floor; the parapet's top is the highest point."""

_FOUNDATION_M = 0.5


def court_floor() -> Geometry:
    """The paved court between the arcades, facing up."""
    return _floor(-COURT_X_M, COURT_X_M, -COURT_Z_M, COURT_Z_M, 0.0)


def gallery_floor(y: float) -> Geometry:
    """The ring from the arcades' court side to the outer walls, facing up, at height `y`."""
    return merged(
        [
            _floor(-INNER_X_M, INNER_X_M, -INNER_Z_M, -COURT_Z_M, y),
            _floor(-INNER_X_M, INNER_X_M, COURT_Z_M, INNER_Z_M, y),
            _floor(-INNER_X_M, -COURT_X_M, -COURT_Z_M, COURT_Z_M, y),
            _floor(COURT_X_M, INNER_X_M, -COURT_Z_M, COURT_Z_M, y),
        ]
    )


def _floor(x0: float, x1: float, z0: float, z1: float, y: float) -> Geometry:
    return rectangle((x0, y, z0), (x1 - x0, 0.0, 0.0), (0.0, 0.0, z1 - z0))


def outer_walls() -> Geometry:
    """The four walls, inside and outside, the ground below and the roof over the galleries."""
    # Inside the walls' lining, outside a box without a lid, and the coping that closes it.
    inside = profile([(0.0, 0.0), (0.0, ROOF_M)])
    x, z = OUTER_X_M, OUTER_Z_M
    shell = box((-x, -_FOUNDATION_M, -z), (x, PARAPET_M, z), ("-x", "+x", "-y", "-z", "+z"))
    coping: Points = [(0.0, ROOF_M), (0.0, PARAPET_M), (-OUTER_WALL_M, PARAPET_M)]
    return merged(
        [
            around_rectangle(inside, INNER_X_M, INNER_Z_M, inwards=True),
            around_rectangle(profile(coping), INNER_X_M, INNER_Z_M, inwards=True),
            shell,
            gallery_floor(ROOF_M),
        ]
    )


def skirting() -> Geometry:
    """A plinth along the foot of the outer walls' inner side, of one storey."""
    points: Points = [(0.05, 0.0), (0.05, 0.42), *arc((0.0, 0.44), 0.05, -20.0, 70.0, 3), (0, 0.5)]
    return around_rectangle(profile(points), INNER_X_M, INNER_Z_M, inwards=True)


def string_course() -> Geometry:
    """The moulding around the court under a storey's floor, from the ground floor's level."""
    # From the bottom: fascia, ovolo, the shelf over the dentils, and the rounded nosing at the
    # floor.
    t = STOREY_M
    points: Points = [(0.0, t - 0.62), (0.03, t - 0.60), (0.03, t - 0.50)]
    points += [*arc((0.03, t - 0.44), 0.06, -75.0, 0.0, 3), (0.09, t - 0.30)]
    points += [(0.22, t - 0.26), (0.22, t - 0.14)]
    points += [*arc((0.20, t - 0.06), 0.08, -60.0, 20.0, 4), (0.28, t), (0.0, t)]
    return merged(
        [
            around_rectangle(profile(points), COURT_X_M, COURT_Z_M, inwards=True),
            _dentils(t - 0.30, t - 0.42),
        ]
    )


def cornice() -> Geometry:
    """The crowning moulding and the parapet above it, around the court."""
    # From the bottom: fascia, ovolo, the shelf over the dentils, and the crowning moulding.
    t, top = ROOF_M, PARAPET_M
    points: Points = [(0.0, t - 0.75), (0.04, t - 0.72), (0.04, t - 0.60)]
    points += [*arc((0.04, t - 0.52), 0.08, -75.0, 0.0, 4), (0.12, t - 0.36)]
    points += [(0.34, t - 0.30), (0.34, t - 0.16)]
    points += [*arc((0.30, t - 0.04), 0.12, -65.0, 30.0, 5), (0.42, t + 0.06), (0.06, t + 0.10)]
    # Above it the parapet, with a bead under its coping.
    points += [(0.06, top - 0.12), *arc((0.06, top - 0.06), 0.05, -80.0, 80.0, 4)]
    points += [(0.08, top), (-0.42, top), (-0.42, t)]
    return merged(
        [
            around_rectangle(profile(points), COURT_X_M, COURT_Z_M, inwards=True),
            _dentils(t - 0.36, t - 0.50),
        ]
    )


def _dentils(high: float, low: float) -> Geometry:
    """A row of small blocks under a cornice, on all four sides of the court."""
    half, out, pitch = 0.07, 0.20, 0.30
    block = box((-half, low, 0.0), (half, high, out), ("-x", "+x", "-y", "+z"))
    rows = []
    for turn, count, away in (
        (0, 61, COURT_Z_M),
        (180, 61, COURT_Z_M),
        (90, 21, COURT_X_M),
        (-90, 21, COURT_X_M),
    ):
        # A row about the middle of its side, moved out to the wall, and turned to its side.
        at = (count - 1) / 2.0 * pitch
        row = merged([moved(block, placed_at(k * pitch - at, 0.0, 0.0)) for k in range(count)])
        rows.append(moved(moved(row, placed_at(0.0, 0.0, -away)), placed_at(0, 0, 0, turn)))
    return merged(rows)
