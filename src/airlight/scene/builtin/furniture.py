"""Furniture of rounded boxes. Each piece stands on y = 0, centred, its front towards +z."""

from __future__ import annotations

import numpy as np

from ..mesh import Geometry
from .patch import merged
from .profile import Points, arc, profile, revolved
from .solids import box, rounded_box

BOARD_M = 0.022
"""Thickness of the shelf's boards: far thinner than a lattice cell."""


def sofa() -> tuple[Geometry, Geometry]:
    """(upholstery, feet) of a two-seat sofa, 1.9 m wide, 0.9 m deep."""
    # Base, two arms and back; then seat and back cushions.
    parts = [
        rounded_box((-0.75, 0.10, -0.40), (0.75, 0.30, 0.42), 0.04),
        rounded_box((-0.95, 0.10, -0.45), (-0.72, 0.60, 0.45), 0.07),
        rounded_box((0.72, 0.10, -0.45), (0.95, 0.60, 0.45), 0.07),
        rounded_box((-0.75, 0.10, -0.45), (0.75, 0.78, -0.22), 0.08),
    ]
    for x in (-0.36, 0.36):
        parts.append(rounded_box((x - 0.355, 0.30, -0.22), (x + 0.355, 0.45, 0.44), 0.06))
        parts.append(rounded_box((x - 0.34, 0.45, -0.24), (x + 0.34, 0.84, -0.08), 0.07))
    # Feet stand in from the corners.
    feet = [
        box((x - 0.03, 0.0, z - 0.03), (x + 0.03, 0.10, z + 0.03))
        for x in (-0.85, 0.85)
        for z in (-0.36, 0.36)
    ]
    return merged(parts), merged(feet)


def table() -> Geometry:
    """A table, 1.3 x 0.75 m, 0.74 m high."""
    top = rounded_box((-0.65, 0.70, -0.375), (0.65, 0.74, 0.375), 0.012)
    apron = [box((-0.56, 0.62, z - 0.012), (0.56, 0.70, z + 0.012)) for z in (-0.30, 0.30)]
    legs = [_leg(x, z, 0.70, 0.03) for x in (-0.58, 0.58) for z in (-0.31, 0.31)]
    return merged([top, *apron, *legs])


def chair() -> Geometry:
    """A chair with a slatted back at -z, its seat 0.46 m high."""
    seat = rounded_box((-0.22, 0.42, -0.21), (0.22, 0.46, 0.23), 0.015)
    front = [_leg(x, 0.20, 0.43, 0.02) for x in (-0.19, 0.19)]
    back = [_leg(x, -0.19, 0.92, 0.02) for x in (-0.19, 0.19)]
    slats = [
        rounded_box((-0.18, y, -0.205), (0.18, y + 0.07, -0.18), 0.008) for y in (0.56, 0.69, 0.82)
    ]
    return merged([seat, *front, *back, *slats])


def _leg(x: float, z: float, height: float, half: float) -> Geometry:
    return rounded_box((x - half, 0.0, z - half), (x + half, height, z + half), 0.008)


def shelf() -> Geometry:
    """An open shelf of thin boards, 1.2 x 1.9 x 0.32 m, without a back."""
    t = BOARD_M
    sides = [box((x, 0.0, -0.16), (x + t, 1.9, 0.16)) for x in (-0.6, 0.6 - t)]
    boards = [box((-0.6 + t, y, -0.16), (0.6 - t, y + t, 0.16)) for y in shelf_heights()]
    return merged([*sides, *boards])


def shelf_heights() -> list[float]:
    """Undersides of the shelf's boards, metres."""
    return [0.08, 0.44, 0.80, 1.16, 1.52, 1.9 - BOARD_M]


def books(rng: np.random.Generator, colors: int) -> list[Geometry]:
    """Rows of books for the `shelf`, as one geometry for each of `colors` bindings."""
    piles: list[list[Geometry]] = [[] for _ in range(colors)]
    # Each board is filled from the left to a place of its own.
    for base in shelf_heights()[:5]:
        at, end = -0.57, float(rng.uniform(0.1, 0.5))
        while at < end:
            thick, tall, deep = rng.uniform((0.018, 0.19, 0.14), (0.05, 0.30, 0.21))
            low = (at, base + BOARD_M, -0.13)
            book = box(low, (at + thick - 0.001, low[1] + tall, -0.13 + deep))
            piles[int(rng.integers(colors))].append(book)
            at += float(thick)
    return [merged(pile) for pile in piles if pile]


def vase() -> Geometry:
    """A bellied vase, 0.32 m high."""
    # Up the outside, over the lip, and a little way down the inside.
    points: Points = [(0.0, 0.0), (0.05, 0.0), (0.055, 0.01), (0.085, 0.07), (0.10, 0.13)]
    points += [(0.095, 0.18), (0.065, 0.235), (0.04, 0.27), (0.038, 0.29)]
    points += [*arc((0.05, 0.315), 0.008, -60.0, 170.0, 4), (0.035, 0.29), (0.03, 0.25)]
    return revolved(profile(points, crease_deg=50.0), 32)


def lamp_shade() -> Geometry:
    """A pendant lamp of metal hanging from y = 0 on a thin rod; its shade opens downwards."""
    # The rod, its cap, and the bell of the shade; the inside back up.
    points: Points = [(0.008, 0.0), (0.006, -0.55), (0.03, -0.56), (0.05, -0.60)]
    points += [*arc((0.02, -0.78), 0.20, 80.0, 5.0, 8), (0.205, -0.77), *_inner_shade()]
    return revolved(profile(points[::-1], crease_deg=40.0), 36)


def _inner_shade() -> Points:
    return [*arc((0.02, -0.78), 0.185, 5.0, 80.0, 8), (0.0, -0.60)]


def picture_frame(width_m: float, height_m: float) -> tuple[Geometry, Geometry]:
    """(frame, canvas) hanging around the origin, facing +z, its back at z = 0."""
    x, y, b = width_m / 2.0, height_m / 2.0, 0.04
    # Top and bottom bars span the corners, the upright ones fit between them.
    bars = [
        rounded_box((-x - b, y, 0.0), (x + b, y + b, 0.03), 0.006),
        rounded_box((-x - b, -y - b, 0.0), (x + b, -y, 0.03), 0.006),
        rounded_box((-x - b, -y, 0.0), (-x, y, 0.03), 0.006),
        rounded_box((x, -y, 0.0), (x + b, y, 0.03), 0.006),
    ]
    return merged(bars), box((-x, -y, 0.0), (x, y, 0.012), ("+z",))
