"""Walls among 26 neighbours: which hops surfaces stop, and what bounces back, in NumPy.

Hops are numbered as in lattice26.hops(); states are its power units, W. A cell's six faces are
open by shares; an edge or corner hop takes any of its face-by-face paths, equally likely.
Source: ours. differs: Billeter2012 eq. 3 drops what blockers stop; a foggy room then holds a
quarter to two thirds of its light.
"""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .lattice26 import RHO, hops, leaving_power
from .medium import mean_transmittance

# Lattice-wide order of a cell's six incoming hops.
FACE_HOPS = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
# Keeps the split of a stopped hop over the walls around its cell defined where none is closed.
SPLIT_FLOOR = 1e-3
# Net direction per power of diffusely reflected light, as track: that of a cosine lobe.
REFLECTED_TRACK = 2.0 / 3.0
# Walls that touch leave nothing between them.
_LEAST = 1e-3


@cache
def face_numbers() -> tuple[tuple[int, int, int], ...]:
    """For each of the 26 hops the hop number of its face hop along x, y, z; -1 for none."""
    offsets = [tuple(o) for o in hops().offsets.tolist()]
    rows = []
    for offset in offsets:
        single = [
            tuple(step if k == axis else 0 for k in range(3)) for axis, step in enumerate(offset)
        ]
        rows.append(tuple(offsets.index(s) if any(s) else -1 for s in single))
    return tuple(rows)  # type: ignore[arg-type]


@cache
def returned_sharpness() -> float:
    """B / (A n) of reflected light: the lobe that sends no net power back into a flat wall.

    differs: a cosine lobe (2) would draw power out of the wall, as a two-band function is
    negative behind itself.
    """
    # No net power goes into the wall: the hops' constant terms balance their linear ones.
    table = hops()
    into = table.directions[:, 2] < -1e-9
    along = -table.directions[into, 2]
    return float(table.weights[into].sum() / (RHO * (table.weights[into] @ along)))


def share_between(values: ArrayLike, most: ArrayLike) -> F64:
    """The share (n,) that what surfaces cover of a face has of what they can cover there, at most.

    `values` (n, 4) are the shares covered around the face's corners, `most` (n, 2, 4) what can be
    covered there of the two cells that it lies between: less where a wall ends at another one.
    """
    covered, whole = np.asarray(values, dtype=np.float64), np.asarray(most, dtype=np.float64)
    shares = np.minimum(covered[:, None], whole).sum(-1) / np.maximum(whole.sum(-1), _LEAST)
    return np.asarray(np.maximum(covered.mean(-1), shares.max(-1)))


def free_sharpness() -> float:
    """B / (A n) of the sharpest lobe of which no hop takes less than nothing."""
    # A hop straight back takes 1 - RHO B/A of what an isotropic cell gives it.
    return 1.0 / RHO


def open_hops(faces: ArrayLike) -> F64:
    """Open share (26, Z, Y, X) of each cell's outgoing hops.

    `faces` (6, Z, Y, X): the open shares of each cell's incoming face hops in the order FACE_HOPS.
    A hop takes the mean over its face-by-face paths (1, 2 or 6) of the product of the faces'
    visibility; what leaves the lattice is never stopped.
    """
    # All orders of single steps lead to the neighbour; light takes each alike.
    leaving = _leaving_faces(np.asarray(faces, dtype=np.float64))
    made = []
    for offset in hops().offsets.tolist():
        axes = [axis for axis in range(3) if offset[axis]]
        paths = [_path_visibility(leaving, offset, order) for order in permutations(axes)]
        made.append(np.mean(paths, axis=0))
    return np.array(made)


def _leaving_faces(faces: F64) -> F64:
    """(6, Z, Y, X): visibility of each cell's outgoing faces, 1 where hops leave the lattice."""
    leaving = np.ones_like(faces)

    # A cell's outgoing face is the next cell's incoming one.
    for index, offset in enumerate(FACE_HOPS):
        leaving[index] = _seen_at(faces[index], offset)
    return leaving


def _seen_at(cells: F64, offset: tuple[int, ...] | list[int]) -> F64:
    """Value (Z, Y, X) at cell + (dx, dy, dz); 1 beyond the lattice."""
    # A rim of open cells: nothing stops light that leaves the lattice.
    padded = np.pad(cells, 1, constant_values=1.0)
    nz, ny, nx = cells.shape
    dx, dy, dz = offset
    return padded[1 + dz : 1 + dz + nz, 1 + dy : 1 + dy + ny, 1 + dx : 1 + dx + nx]


def _path_visibility(leaving: F64, offset: list[int], order: tuple[int, ...]) -> F64:
    product: F64 = np.ones(leaving.shape[1:])
    at = [0, 0, 0]
    # Each face is that of the cell to which the steps before have led.
    for axis in order:
        face = 2 * axis + (0 if offset[axis] > 0 else 1)
        product = product * _seen_at(leaving[face], at)
        at[axis] += offset[axis]
    return product


def wall_normals(blocked: F64, hop: int) -> F64:
    """Mean normal (Z, Y, X, 3), facing the cell, of what stops hop number `hop`.

    The hop's axes share by how closed the cell's own faces are; the 1-norm is 1, so that walls
    around a corner return the sum of their lobes.
    """
    # Axes share by how closed their faces are, with a floor where none is.
    numbers, offset = face_numbers()[hop], hops().offsets[hop]
    shares = np.stack(
        [blocked[n] + SPLIT_FLOOR if n >= 0 else np.zeros(blocked.shape[1:]) for n in numbers],
        axis=-1,
    )
    return np.asarray(-offset * shares / shares.sum(axis=-1, keepdims=True))


def bounced(
    state: ArrayLike,
    sigma_s: ArrayLike,
    sigma_t: ArrayLike,
    cell_size_m: float,
    blocked: ArrayLike,
    reflectance: ArrayLike,
) -> tuple[F64, F64]:
    """(state, track) that walls give back to the cells (C, Z, Y, X, 4) whose light they stop.

    To be added to a step that lost the share `blocked` (26, Z, Y, X) of each hop. `sigma_s`,
    `sigma_t` m^-1 and `reflectance` broadcast to (C, Z, Y, X). The wall stands half a hop away:
    light is attenuated to it, reflected, and attenuated on its way back; what is scattered
    meanwhile stays in the cell. A two-band hop may carry negative power; a wall then gives all of
    it back, or absorbing it would add light.
    """
    before, table = np.asarray(state, dtype=np.float64), hops()
    shape = before.shape[:-1]
    scatter, total, white = (
        np.broadcast_to(np.asarray(v, dtype=np.float64), shape)
        for v in (sigma_s, sigma_t, reflectance)
    )
    shut = np.asarray(blocked, dtype=np.float64)
    returned, track = np.zeros_like(before), np.zeros_like(before)
    for j, direction in enumerate(table.directions):
        power = leaving_power(before, j)
        # Half a hop to the wall: transmittance exp(-sigma_t l / 2), mean path in the medium.
        half_m = 0.5 * cell_size_m * float(table.lengths[j])
        left = np.exp(-half_m * total)
        way_m = half_m * mean_transmittance(half_m * total)
        # Reflected into a lobe about the normal of the wall, attenuated on both legs.
        mirror = np.where(power < 0.0, 1.0, white)
        stopped = shut[j] * power
        back = mirror * stopped * left
        normal = wall_normals(shut, j)
        # Both legs add track length, and scatter in the cell.
        track += (way_m * stopped)[..., None] * np.array([1.0, *(RHO * direction)])
        track += (way_m * back)[..., None] * _lobe(normal, REFLECTED_TRACK)
        returned += (left * back)[..., None] * _lobe(normal, returned_sharpness())
        returned[..., 0] += scatter * way_m * (stopped + back)
    return returned, track


def _lobe(normal: F64, sharpness: float) -> F64:
    return np.concatenate([np.ones((*normal.shape[:-1], 1)), sharpness * normal], axis=-1)
