"""Columns, piers, pilasters, balusters and other turned and moulded stone.

All stand on y = 0 around the y axis; lengths in metres.
"""

from __future__ import annotations

import numpy as np

from ..checks import F64
from ..mesh import Geometry
from .patch import lattice_normals, merged, patch
from .profile import Points, arc, around_rectangle, profile, revolved
from .solids import box

SPRING_M = 3.8
"""Height at which columns end and arches begin, above their storey's floor."""

PEDESTAL_M = 1.0
ABACUS_HALF_M = 0.40


def column(height_m: float, radius_m: float, *, twist_turns: float = 0.0) -> Geometry:
    """A column with plinth, attic base, fluted shaft and leaf capital, `height_m` in all."""
    r = radius_m
    base_top, capital = 0.14 + 0.80 * r, 0.62
    shaft_top = height_m - capital
    # From the ground: plinth, base, shaft, capital, and the abacus with its lid.
    parts = [
        box((-1.5 * r, 0.0, -1.5 * r), (1.5 * r, 0.14, 1.5 * r), ("-x", "+x", "+y", "-z", "+z")),
        revolved(profile(_attic_base(r, 0.14)), 22),
        _shaft(r, base_top, shaft_top, twist_turns),
        _capital(0.84 * r, shaft_top, height_m - 0.16),
        around_rectangle(profile(_abacus(height_m)), ABACUS_HALF_M - 0.05, ABACUS_HALF_M - 0.05),
        box(
            (-ABACUS_HALF_M, height_m - 0.16, -ABACUS_HALF_M),
            (ABACUS_HALF_M, height_m, ABACUS_HALF_M),
            ("+y",),
        ),
    ]
    return merged(parts)


def _attic_base(r: float, foot: float) -> Points:
    """Torus, scotia, torus and fillet, as Vitruvius has them, 0.8 r high above `foot`."""
    points = arc((1.22 * r, foot + 0.17 * r), 0.17 * r, -80.0, 80.0, 4)
    points += [(1.20 * r, foot + 0.38 * r)]
    points += arc((1.26 * r, foot + 0.46 * r), 0.12 * r, 215.0, 145.0, 2)
    points += arc((1.08 * r, foot + 0.65 * r), 0.10 * r, -80.0, 80.0, 3)
    return [*points, (1.04 * r, foot + 0.76 * r), (1.0 * r, foot + 0.84 * r)]


def _shaft(r: float, low: float, high: float, twist_turns: float) -> Geometry:
    """Sixteen flutes that end in round scoops, on a shaft with entasis; or twisted fillets."""
    flutes, per_flute = (12 if twist_turns else 16), 4
    angle = np.linspace(0.0, 2.0 * np.pi, flutes * per_flute + 1)[None, :]
    # Rings, dense where flutes begin and end.
    scoop = np.array([0.0, 0.02, 0.045])
    middle = np.linspace(0.07, 0.93, 8 if twist_turns else 4)
    t = np.concatenate([scoop, middle, 1.0 - scoop[::-1]])[:, None]
    entasis = r * (1.0 - 0.16 * t**1.8)
    # A quarter circle at both ends of a flute is its scoop.
    ends = np.clip(np.minimum(t, 1.0 - t) / 0.06, 0.0, 1.0)
    depth = 0.085 * np.sqrt(1.0 - (1.0 - ends) ** 2)
    # The radius at each angle and height: entasis, less the depth of the flute.
    turned = angle + 2.0 * np.pi * twist_turns * t
    radius = entasis * (1.0 - depth * np.abs(np.sin(0.5 * flutes * angle)))
    height = np.broadcast_to(low + (high - low) * t, radius.shape)
    positions = np.stack([radius * np.sin(turned), height, radius * np.cos(turned)], axis=-1)
    # Rows run upwards and columns counter-clockwise, so that their cross product points inwards.
    normals = -lattice_normals(positions, closed_columns=True)
    uvs = np.stack([np.broadcast_to(r * angle, radius.shape), -height], axis=-1)
    return patch(positions, normals, uvs)


def _capital(neck: float, low: float, high: float) -> Geometry:
    """Astragal, and a bell of two tiers of eight curling leaves that widen under the abacus."""
    # The bell widens upwards by the cube, so that it meets the abacus in a curl.
    angle = np.linspace(0.0, 2.0 * np.pi, 40 + 1)[None, :]
    t = np.linspace(0.0, 1.0, 12)[:, None]
    bell = neck * (1.0 + 0.06 * t) + 0.15 * t**3.0
    # The second tier stands half a leaf aside and over the first.
    first, second = (_leaf_tier(t, angle, *tier) for tier in ((0.0, 0.52, 0.0), (0.30, 0.95, 0.5)))
    radius = bell + 0.055 * np.maximum(first, 1.15 * second)
    height = np.broadcast_to(low + (high - low) * t, radius.shape)
    positions = np.stack([radius * np.sin(angle), height, radius * np.cos(angle)], axis=-1)
    normals = -lattice_normals(positions, closed_columns=True)
    uvs = np.stack([np.broadcast_to(0.3 * angle, radius.shape), -height], axis=-1)
    # The astragal: a ring around the neck.
    ring = [(neck, low - 0.03), *arc((neck, low), 0.03, -80.0, 80.0, 3), (neck, low + 0.03)]
    return merged([patch(positions, normals, uvs), revolved(profile(ring), 22)])


def _leaf_tier(t: F64, angle: F64, low: float, high: float, shift: float) -> F64:
    """How far the leaves between `low` and `high` stand out of the bell, 0 to 1."""
    # Eight leaves around, each a lobe; the tips curl outwards.
    lobe = np.abs(np.cos(4.0 * angle + np.pi * shift)) ** 0.7
    along = np.clip((t - low) / (high - low), 0.0, 1.0)
    curl = 0.35 * np.sqrt(along) + 0.65 * along**4
    return np.where(t <= high + 1e-9, lobe * curl, 0.0)


def _abacus(top: float) -> Points:
    return [
        (-0.17, top - 0.16),
        (-0.02, top - 0.16),
        *arc((-0.02, top - 0.10), 0.05, -70.0, 0.0, 3),
        (0.03, top - 0.07),
        (0.05, top - 0.07),
        (0.05, top),
    ]


def pier(half_m: float, height_m: float) -> Geometry:
    """A square pier with a moulded base and, at the arches' spring, an impost; open top."""
    return around_rectangle(
        profile([*_pier_base(), *_impost(SPRING_M), (0.0, height_m)]), half_m, half_m
    )


def pilaster(half_x_m: float, half_z_m: float) -> Geometry:
    """A flat half pier up to the spring, to be set half into a wall; closed by its impost."""
    # The impost without its upper end, then a lid towards the middle.
    top = [*_impost(SPRING_M)[:-2], (0.08, SPRING_M), (-min(half_x_m, half_z_m), SPRING_M)]
    return around_rectangle(profile([*_pier_base(), *top]), half_x_m, half_z_m)


def pedestal(half_m: float) -> Geometry:
    """A square block with base and cap under an upper column, `PEDESTAL_M` high."""
    h = PEDESTAL_M
    # A base with a torus, the die, and a cap with an ovolo.
    points = [(0.06, 0.0), (0.06, 0.12), *arc((0.0, 0.18), 0.05, -60.0, 60.0, 3), (0.0, 0.26)]
    points += [(0.0, h - 0.18), *arc((0.0, h - 0.12), 0.045, -75.0, 0.0, 3)]
    points += [(0.06, h - 0.12), (0.06, h), (-half_m, h)]
    return around_rectangle(profile(points), half_m, half_m)


def _pier_base() -> Points:
    return [(0.06, 0.0), (0.06, 0.22), *arc((0.0, 0.29), 0.055, -60.0, 60.0, 4), (0.0, 0.37)]


def _impost(top: float) -> Points:
    cyma = arc((0.0, top - 0.13), 0.05, -80.0, 0.0, 3)
    return [(0.0, top - 0.20), *cyma, (0.08, top - 0.11), (0.08, top), (0.0, top + 0.001)]


def baluster() -> Geometry:
    """A vase-shaped baluster between the rails of a balustrade, 0.62 m high from y = 0.12."""
    # From the foot over the belly to the neck, and a cap under the rail.
    points: Points = [(0.06, 0.12), (0.06, 0.17), (0.04, 0.20)]
    points += [(0.062, 0.27), (0.074, 0.34), (0.066, 0.42), (0.042, 0.52), (0.032, 0.60)]
    points += [(0.048, 0.645), (0.034, 0.67), (0.058, 0.69), (0.058, 0.74)]
    return revolved(profile(points, crease_deg=60.0), 8)


def fountain() -> tuple[Geometry, Geometry]:
    """(stone, water): a round basin 2.6 m wide with a bowl on a foot, 1.75 m high."""
    # Profiles, from outside to the axis, turned about it.
    wall: Points = [(1.34, 0.0), (1.34, 0.10), (1.24, 0.16), (1.20, 0.36)]
    wall += arc((1.24, 0.47), 0.08, -90.0, 90.0, 6)
    wall += [(1.08, 0.55), (1.06, 0.52), (1.04, 0.10), (0.32, 0.10)]
    # The foot, the bowl upon it, and a knob in the middle of the bowl.
    foot: Points = [(0.34, 0.10), (0.34, 0.42), (0.26, 0.48), (0.15, 0.56), (0.12, 0.80)]
    foot += arc((0.13, 0.92), 0.06, -70.0, 70.0, 5)
    foot += [(0.11, 1.05), (0.16, 1.14), (0.40, 1.22), (0.58, 1.32)]
    foot += arc((0.63, 1.38), 0.045, -60.0, 150.0, 6)
    foot += [(0.50, 1.32), (0.10, 1.26), (0.07, 1.34), (0.06, 1.55)]
    foot += arc((0.0, 1.66), 0.10, -50.0, 89.9, 6)
    # Water stands below the rims of the basin and of the bowl.
    pool = revolved(profile([(1.06, 0.44), (0.0, 0.44)]), 48)
    bowl = revolved(profile([(0.57, 1.36), (0.0, 1.36)]), 32)
    stone = merged([revolved(profile(wall), 64), revolved(profile(foot), 40)])
    return stone, merged([pool, bowl])
