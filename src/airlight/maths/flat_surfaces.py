"""Flat surfaces in the map of a light, where nothing is close before them, in NumPy.

Light of such surfaces, where they are oblique to the cells of a lattice, enters it farther before
them than half a cell. Source: ours. Lengths are in cells unless said otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .arrays import F64
from .lattice6 import hops
from .transforms import smoothstep

Bools = NDArray[np.bool_]

ON_PLANE, OFF_PLANE, WALL, BEFORE_FLAT = 0.1, 0.25, 0.6, 1.0
"""Cells: how far from a plane its parts are at most; from how far on another surface is off it, and
is a wall before it; how far before flat surfaces light enters."""


@dataclass(frozen=True, eq=False)
class DepthMap:
    """What a view shows: `depth` (side, side), 1 where nothing is, and `clip_from_world`."""

    depth: F64
    clip_from_world: F64

    def shown_on_line(self, p: F64) -> tuple[Bools, F64, F64]:
        """Of world points (n, 3), m: whether they are in the map, its depth there, that point, m.

        Twin: shown_on_line of wgsl/flat_surfaces.wgsl.
        """
        # The texel of each point.
        clip = np.concatenate([p, np.ones((len(p), 1))], axis=1) @ self.clip_from_world.T
        uv = np.array([0.5, -0.5]) * clip[:, :2] / clip[:, 3:] + 0.5
        is_known = (clip[:, 3] > 0.0) & (uv >= 0.0).all(axis=1) & (uv < 1.0).all(axis=1)
        side = len(self.depth)
        texel = (np.clip(uv, 0.0, 1.0) * (side - 1e-3)).astype(np.intp)

        # The point that its middle shows.
        depth = self.depth[texel[:, 1], texel[:, 0]]
        centre = (texel + 0.5) / side * [2.0, -2.0] + [-1.0, 1.0]
        shown = np.concatenate([centre, depth[:, None], np.ones((len(p), 1))], axis=1)
        world = shown @ np.linalg.inv(self.clip_from_world).T
        return is_known, depth, world[:, :3] / world[:, 3:]


def axis_across(n: F64, k: int) -> F64:
    """(m, 4): the k-th axis across unit vectors n (m, 3), and its weight; three weights are 2."""
    weight = 1.0 - n[:, k] ** 2
    across = -n[:, k, None] * n
    across[:, k] += 1.0
    return np.concatenate([across / np.sqrt(np.maximum(weight, 1e-6))[:, None], weight[:, None]], 1)


def is_on_plane(off: F64) -> F64:
    """How far what is so many cells off a plane is a part of it, 0 to 1."""
    return 1.0 - smoothstep(ON_PLANE, OFF_PLANE, np.abs(off))


def is_open(height: F64) -> F64:
    """How far what is so many cells above a plane, seen past it, is not a wall before it."""
    return 1.0 - smoothstep(OFF_PLANE, WALL, height)


def flatness(shown: DepthMap, p: F64, n: F64, cell: float) -> F64:
    """How flat a map shows what is around points p (m, 3), metres, of normals n: 0 to 1.

    The share of six points half a `cell` (m) away along the surface that lie near its plane.
    """
    near = np.zeros(len(p))
    for k in range(3):
        axis = axis_across(n, k)
        for away in (0.5, -0.5):
            is_known, depth, point = shown.shown_on_line(p + away * cell * axis[:, :3])
            off = ((point - p) * n).sum(axis=1) / cell
            near += np.where(is_known & (depth < 1.0), axis[:, 3] * is_on_plane(off), 0.0)
    return 0.25 * near


def clearance(shown: DepthMap, p: F64, n: F64, cell: float) -> F64:
    """How far a map shows nothing else up to BEFORE_FLAT cells before planes through p: 0 to 1."""
    open = np.ones(len(p))
    for before in (0.5, 0.5 + 0.5 * (BEFORE_FLAT - 0.5), BEFORE_FLAT):
        is_known, depth, point = shown.shown_on_line(p + before * cell * n)
        height = ((point - p) * n).sum(axis=1) / cell
        passes = np.where(depth >= 1.0, 1.0, is_open(height))
        open = np.minimum(open, np.where(is_known, passes, 0.0))
    return open


def free_sharpness(n: F64, sharpness: float) -> F64:
    """(m,): b over P n / 4pi, at most `sharpness`, of lobes along unit vectors n (m, 3) that no hop
    takes less than nothing of. Twin: free_sharpness of wgsl/lobes.wgsl.
    """
    # The hop away from the surface along the axis that it faces most has the least.
    constant, directional = hops()[0].matrix[0, :2]
    along = np.abs(n).max(axis=1)
    return np.asarray(np.minimum(sharpness, constant / np.maximum(directional * along, 1e-6)))
