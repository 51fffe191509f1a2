"""A carved lion's mask on a round stone shield."""

from __future__ import annotations

import numpy as np

from ..checks import F64
from ..mesh import Geometry
from .patch import lattice_normals, merged, moved, patch
from .profile import Points, arc, profile, revolved


def lion_shield(radius_m: float = 0.95) -> Geometry:
    """A shield facing +z around the origin, 0.35 m deep, its moulded rim turned about z."""
    rings, spokes = 28, 64
    # A polar lattice over the shield, raised by the mask.
    rho = np.linspace(0.0, 0.84, rings + 1)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, spokes + 1)[None, :]
    x, y = rho * np.cos(angle), rho * np.sin(angle)
    depth = 0.06 + _mask(x, y, rho, angle)
    positions = radius_m * np.stack([x, y, depth], axis=-1)
    normals = lattice_normals(positions, closed_columns=True)
    # At the middle all spokes meet, and no cross product says a normal.
    normals[0] = (0.0, 0.0, 1.0)
    # The face, and a moulded rim around it.
    face = patch(positions, normals, positions[..., :2] * (1.0, -1.0))
    rim: Points = [(1.0, 0.0), (1.0, 0.10), *arc((0.96, 0.12), 0.04, 0.0, 150.0, 5)]
    rim += [(0.88, 0.10), (0.84, 0.06)]
    ring = revolved(profile([(radius_m * r, radius_m * h) for r, h in rim]), 40)
    return merged([face, _facing_z(ring)])


def _facing_z(geometry: Geometry) -> Geometry:
    """Turned so that +y becomes +z."""
    quarter = np.eye(4)
    quarter[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    return moved(geometry, quarter)


def _mask(x: F64, y: F64, rho: F64, angle: F64) -> F64:
    """Height of the lion's face over the shield, both in radii; symmetric in x."""

    def bump(cx: float, cy: float, wx: float, wy: float) -> F64:
        return np.exp(-(((np.abs(x) - cx) / wx) ** 2) - ((y - cy) / wy) ** 2)

    # The mane: a ring of locks whose waves follow both angle and radius.
    locks = np.sin(17.0 * angle + 2.2 * np.sin(3.0 * angle) + 9.0 * rho)
    mane = (
        0.10
        * np.minimum(rho / 0.2, 1.0)
        * np.exp(-(((rho - 0.60) / 0.20) ** 2))
        * (1.0 + 0.40 * locks)
    )
    inner = (
        np.minimum(rho / 0.2, 1.0)
        * np.exp(-(((rho - 0.45) / 0.08) ** 2))
        * 0.03
        * np.sin(23.0 * angle - 12.0 * rho)
    )
    # The face, from its large forms to its small ones, each a bump mirrored in x.
    skull = 0.20 * np.exp(-((np.hypot(x, y * 0.85) / 0.42) ** 4))
    brow = 0.055 * bump(0.14, 0.16, 0.11, 0.045)
    eyes = -0.075 * bump(0.15, 0.07, 0.065, 0.045) + 0.045 * bump(0.15, 0.07, 0.035, 0.025)
    nose = 0.09 * bump(0.0, 0.02, 0.065, 0.17) + 0.06 * bump(0.0, -0.13, 0.085, 0.05)
    muzzle = 0.10 * bump(0.09, -0.20, 0.10, 0.085) + 0.03 * bump(0.0, -0.38, 0.09, 0.05)
    mouth = -0.12 * bump(0.0, -0.30, 0.13, 0.030) - 0.03 * bump(0.0, -0.22, 0.015, 0.06)
    cheeks = 0.04 * bump(0.27, -0.06, 0.09, 0.13)
    ears = 0.08 * bump(0.33, 0.36, 0.09, 0.09) - 0.05 * bump(0.33, 0.36, 0.04, 0.05)
    return mane + inner + skull + brow + eyes + nose + muzzle + mouth + cheeks + ears
