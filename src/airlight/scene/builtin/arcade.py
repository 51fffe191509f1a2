"""One bay of a round-arched arcade and of the vaulted gallery behind it.

A bay's frame: x along the arcade, +z into the court, y = 0 its storey's floor, the origin on
the arcade's axis. The gallery lies at z from -0.3 to -3.9, its outer wall behind it.
"""

from __future__ import annotations

import numpy as np

from ..checks import F64
from ..mesh import Geometry
from .columns import SPRING_M, baluster
from .patch import facing, merged, moved, patch, placed_at
from .profile import Points, along_x, arc, around_arch, profile
from .solids import box

BAY_M = 2.4
STOREY_M = 5.8
ARCH_RADIUS_M = 0.92
WALL_HALF_M = 0.3
GALLERY_M = 3.6
OUTER_WALL_Z = -WALL_HALF_M - GALLERY_M
VAULT_RISE_M = 1.2

_ARCH_STEPS = 20


def arch_wall() -> Geometry:
    """The wall above the columns, SPRING_M to STOREY_M, with its arch cut out."""
    # Both faces: from the rim of the arch up to the storey's top.
    angle = np.linspace(np.pi, 0.0, _ARCH_STEPS + 1)
    half, top = BAY_M / 2.0, STOREY_M
    rim = np.stack([np.cos(angle), np.sin(angle)], axis=1) * ARCH_RADIUS_M + (0.0, SPRING_M)
    lower = np.concatenate([[(-half, SPRING_M)], rim, [(half, SPRING_M)]])
    upper = np.stack([lower[:, 0], np.full(len(lower), top)], axis=1)
    sheet = np.stack([lower, upper])
    # The underside of the arch between them.
    soffit = np.repeat(rim[None], 2, axis=0)
    z = np.broadcast_to(np.array([[-WALL_HALF_M], [WALL_HALF_M]]), soffit.shape[:2])
    inwards = np.stack([-np.cos(angle), -np.sin(angle), np.zeros_like(angle)], axis=1)
    arc_m = np.broadcast_to(ARCH_RADIUS_M * (np.pi - angle), z.shape)
    under = patch(
        np.concatenate([soffit, z[..., None]], axis=-1),
        np.broadcast_to(inwards, (2, *inwards.shape)),
        np.stack([arc_m, z], axis=-1),
    )
    return merged([_upright(sheet, WALL_HALF_M, 1.0), _upright(sheet, -WALL_HALF_M, -1.0), under])


def _upright(sheet: F64, z: float, facing: float) -> Geometry:
    """A lattice of (x, y) in the plane at `z`, facing +z or -z; uv continue from bay to bay."""
    positions = np.concatenate([sheet, np.full((*sheet.shape[:2], 1), z)], axis=-1)
    normals = np.broadcast_to((0.0, 0.0, facing), positions.shape)
    return patch(positions, normals, sheet * (facing, -1.0))


def archivolt() -> Geometry:
    """The arch's moulding on both faces of the wall: two fasciae and a hood, with a keystone."""
    # Two fasciae under a rounded hood, from outside to the arch's edge.
    points: Points = [(0.22, 0.0), (0.22, 0.055), *arc((0.185, 0.055), 0.03, 10.0, 170.0, 2)]
    points += [(0.15, 0.045), (0.08, 0.045), (0.08, 0.03), (0.0, 0.03), (0.0, -0.01)]
    front = moved(
        around_arch(profile(points), ARCH_RADIUS_M, _ARCH_STEPS),
        placed_at(0.0, SPRING_M, WALL_HALF_M),
    )
    # The keystone cuts through the moulding and stands out of it; then all of it on the other face.
    crown = SPRING_M + ARCH_RADIUS_M
    key = box((-0.09, crown - 0.03, 0.0), (0.09, crown + 0.26, WALL_HALF_M + 0.12))
    half = merged([front, key])
    return merged([half, moved(half, placed_at(0.0, 0.0, 0.0, turn_deg=180.0))])


def blind_arch() -> Geometry:
    """A moulding of the same arch on the gallery's outer wall."""
    # A flatter moulding, whose back lies in the wall.
    points: Points = [(0.14, 0.0), (0.14, 0.05), (0.05, 0.05), (0.05, 0.03), (0.0, 0.03), (0.0, 0)]
    ring = around_arch(profile(points), ARCH_RADIUS_M, _ARCH_STEPS)
    return moved(ring, placed_at(0.0, SPRING_M, OUTER_WALL_Z))


def groin_vault(half_x_m: float, half_z_m: float, steps: int = 10) -> Geometry:
    """Two crossing elliptic barrels over a bay, seen from below; springs at SPRING_M.

    The height is the greater of the two barrels; the creases run along the lattice's diagonals.
    """
    angle = np.linspace(0.0, np.pi, steps + 1)
    a, b = np.meshgrid(angle, angle)
    x, z = -half_x_m * np.cos(a), -half_z_m * np.cos(b)
    webs = []
    # Each barrel gives the two webs where it is the higher one.
    for across_x in (True, False):
        rise = np.sin(a if across_x else b)
        positions = np.stack([x, SPRING_M + VAULT_RISE_M * rise, z], axis=-1)
        # Normals by the gradient of the ellipse, turned downwards.
        bent_x, bent_z = (x / half_x_m**2, 0.0 * z) if across_x else (0.0 * x, z / half_z_m**2)
        normals = -np.stack([bent_x, (rise + 1e-9) / VAULT_RISE_M, bent_z], axis=-1)
        # Texture coordinates follow the arc, by about its length.
        length_x, length_z = 1.25 * half_x_m * a, 1.25 * half_z_m * b
        flat = (length_x, z) if across_x else (x, length_z)
        webs.append(_web(positions, normals, np.stack(flat, axis=-1), np.sin(a), np.sin(b)))
    return merged(webs)


def _web(positions: F64, normals: F64, uvs: F64, sin_a: F64, sin_b: F64) -> Geometry:
    """The triangles of a vault's lattice on which this web is the higher one."""
    # Diagonals run along the groins, symmetric in all quarters: else the groins would be saw-
    # toothed.
    rows, columns = sin_a.shape
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    corner = (i * columns + j)[..., None]
    same = ((2 * i < rows - 1) == (2 * j < columns - 1))[..., None]
    main = corner + np.array([0, 1, columns + 1, 0, columns + 1, columns])
    anti = corner + np.array([0, 1, columns, 1, columns + 1, columns])
    triangles = np.where(same, main, anti).reshape(-1, 3)
    # A triangle belongs to the web that is higher there, because a groin vault is the upper one of
    # two barrels.
    own = positions[..., 1].ravel()[triangles].sum(axis=1)
    best = SPRING_M + VAULT_RISE_M * np.maximum(sin_a, sin_b)
    kept = triangles[own >= best.ravel()[triangles].sum(axis=1) - 1e-9]
    return facing(positions.reshape(-1, 3), kept, normals.reshape(-1, 3), uvs.reshape(-1, 2))


def transverse_rib(half_width_m: float) -> Geometry:
    """The arch that crosses the gallery between two vaults, at x = 0."""
    half_z, drop = GALLERY_M / 2.0 + 0.05, 0.12
    angle = np.linspace(0.0, np.pi, 17)
    centre = OUTER_WALL_Z + GALLERY_M / 2.0
    # Two ellipses a little apart: the rib's underside is the inner one, its cheeks lie between
    # both.
    inner, outer = (
        np.stack(
            [centre - (half_z - e) * np.cos(angle), SPRING_M + (VAULT_RISE_M - e) * np.sin(angle)],
            axis=1,
        )
        for e in (drop, -0.06)
    )
    inwards = -np.stack([-np.cos(angle) / half_z, np.sin(angle) / VAULT_RISE_M], axis=1)
    across = np.array([-half_width_m, half_width_m])[:, None]
    # The underside, as wide as the rib.
    under = np.stack(
        [np.broadcast_to(across, (2, 17)), *(np.tile(inner[:, k], (2, 1)) for k in (1, 0))], axis=-1
    )
    under_n = np.broadcast_to(
        np.stack([np.zeros(17), inwards[:, 1], inwards[:, 0]], axis=-1), under.shape
    )
    arc_m = np.broadcast_to(1.5 * angle, (2, 17))
    parts = [patch(under, under_n, np.stack([arc_m, under[..., 0]], axis=-1))]
    # A cheek on each side, flat.
    for side in (-1.0, 1.0):
        cheek = np.stack([inner, outer])
        points = np.stack(
            [np.full(cheek.shape[:2], side * half_width_m), cheek[..., 1], cheek[..., 0]], axis=-1
        )
        normals = np.broadcast_to((side, 0.0, 0.0), points.shape)
        parts.append(patch(points, normals, cheek * (1.0, -1.0)))
    return merged(parts)


def balustrade() -> Geometry:
    """Rails and balusters between two pedestals, `PEDESTAL_M` less a hand high."""
    # The bottom rail, and the profile of the handrail.
    half = BAY_M / 2.0 - 0.30
    foot = box((-half, 0.0, -0.13), (half, 0.12, 0.13), ("+y", "-z", "+z"))
    rail: Points = [(-0.09, 0.74), (0.09, 0.74), *arc((0.10, 0.80), 0.05, -60.0, 60.0, 3)]
    rail += [(0.15, 0.86), (0.15, 0.92), (-0.15, 0.92), (-0.15, 0.86)]
    rail += [*arc((-0.10, 0.80), 0.05, 120.0, 240.0, 3), (-0.09, 0.74)]
    # Six balusters stand between them.
    one = baluster()
    places = np.linspace(-0.66, 0.66, 6)
    standing = [moved(one, placed_at(float(x), 0.0, 0.0)) for x in places]
    return merged([foot, along_x(profile(rail), -half, half), *standing])
