"""Regions of a lattice between which slow light is brought at once, in NumPy.

With M one iteration and I the injected state, the sum of all states obeys Q = I + M Q. Power per
cell is taken to be alike within each region; A is then what I - M does between regions, and after a
step the power r under way in them is still to become A^-1 r. Of that a step has added r itself.
Source: ours, after aggregation (Koury1984), with weights that do not depend on the light.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64, I64

Count = tuple[int, int, int]

REGIONS = 64
"""At most: lanes of the workgroup that inverts their matrix."""
FLOOD_STEPS = 16
"""Cells that light spreads from a region's middle."""
OPEN = 0.5
"""Share of a face, either way, above which a region reaches through it."""
SLOWEST = 1e-3
"""Least share of its power that a region is taken to lose in a step."""
_FAR = np.int64(2**32 - 1)


def region_grid(count: Count) -> Count:
    """How many regions there are along x, y, z: about cubes, at most REGIONS of them."""
    side = 1.0
    while True:
        x, y, z = (max(1, round(n / side)) for n in count)
        if x * y * z <= REGIONS:
            return x, y, z
        side *= 1.02


def flooded(count: Count, faces: ArrayLike) -> I64:
    """The region of each cell (Z, Y, X), -1 for none.

    `faces` (6, Z, Y, X): open shares of hops that come in along x, back, along y, back, z, back.
    """
    grid, shape = region_grid(count), count[::-1]
    is_open = _open_both_ways(np.asarray(faces))
    found = np.full(shape, _FAR)
    for turn in range(2):
        # Each box of the grid begins a region in one of its cells; then, where cells of it are
        # still without any, as those on the other side of a wall, another one.
        found = np.where(found == _FAR, _begun(count, grid, is_open, found, turn), found)
        # From cell to cell through open faces; of regions as near the one nearer to the lattice's
        # corner has a cell, so that all axes are alike.
        for _ in range(FLOOD_STEPS):
            nearest = found
            for hop in range(6):
                beside = _came(found, 2 - hop // 2, 1 if hop % 2 == 0 else -1, _FAR)
                reached = np.where(is_open[hop] & (beside != _FAR), beside + 65536, _FAR)
                nearest = np.minimum(nearest, reached)
            found = nearest
    return np.asarray(np.where(found == _FAR, -1, found & 255), dtype=np.int64)


def _open_both_ways(faces: F64) -> NDArray[np.bool_]:
    """Whether light comes in by a hop (6, Z, Y, X) and goes back out.

    In a wall it may go one way alone: what a region had there would be on both of its sides.
    """
    found = []
    for hop in range(6):
        back = _came(faces[hop ^ 1], 2 - hop // 2, 1 if hop % 2 == 0 else -1, 0.0)
        found.append(np.minimum(faces[hop], back) > OPEN)
    return np.stack(found)


def _begun(count: Count, grid: Count, is_open: NDArray[np.bool_], found: I64, turn: int) -> I64:
    """Where regions begin, (Z, Y, X): what `found` is of those cells; far of all others.

    In each box of the grid it is the cell with the fewest closed faces of those without a region,
    and of these the one nearest to the middle. In the second `turn` the boxes with the most such
    cells have the numbers that are left.
    """
    cells = np.moveaxis(np.indices(count[::-1]), 0, -1)[..., ::-1]
    # Of each cell: its box of the grid, and where in that box it lies.
    part = cells * grid // count
    first = -(-part * count // grid)
    x, y, z = np.moveaxis(cells - first, -1, 0)
    wide, high, _ = np.moveaxis(-(-(part + 1) * count // grid) - first, -1, 0)
    # Fewest closed faces, then nearest to the middle, then first: one key orders them.
    closed = 6 - is_open.sum(axis=0)
    off = np.abs(cells - (2 * part + 1) * count // (2 * np.array(grid))).sum(axis=-1)
    key = (closed << 25) + (off << 18) + (z * high + y) * wide + x
    number = (part[..., 2] * grid[1] + part[..., 1]) * grid[0] + part[..., 0]
    ranked = 256 * part.sum(axis=-1) + number
    is_free = (found == _FAR) & (closed < 6)

    # Boxes with the most cells come first, for those get the numbers that are left.
    begun = np.full(found.shape, _FAR)
    boxes = [np.nonzero(is_free.ravel() & (number.ravel() == box))[0] for box in range(_size(grid))]
    order = sorted(
        (box for box in range(_size(grid)) if len(boxes[box])),
        key=lambda box: (-len(boxes[box]), ranked.ravel()[boxes[box][0]]),
    )
    for rank, box in enumerate(order):
        own = box if turn == 0 else _size(grid) + rank
        cell = boxes[box][key.ravel()[boxes[box]].argmin()]
        if own < REGIONS:
            begun.ravel()[cell] = ranked.ravel()[cell] - box + own
    return begun


def _size(count: Count) -> int:
    x, y, z = count
    return x * y * z


def _came(cells: NDArray[Any], axis: int, step: int, far: Any) -> NDArray[Any]:
    """Values moved by `step` along `axis`, `far` coming in."""
    moved = np.roll(cells, step, axis)
    end: list[slice | int] = [slice(None)] * 3
    end[axis] = 0 if step > 0 else -1
    moved[tuple(end)] = far
    return moved


def exchange(regions: ArrayLike, step: Callable[[F64], F64]) -> F64:
    """A (REGIONS, REGIONS): what of 1 W in each cell of region j is missing in region i (i = j)
    after a step, or comes there (negative).

    `step` makes M Q, power alone, of a power Q (Z, Y, X) without direction.
    """
    of = np.asarray(regions)
    counts = sums_of(of, np.ones(of.shape))
    matrix = np.diag(np.where(counts > 0.0, (1.0 + SLOWEST) * counts, 1.0))
    for j in range(REGIONS):
        if counts[j]:
            matrix[:, j] -= sums_of(of, step((of == j).astype(np.float64)))
    return matrix


def sums_of(regions: ArrayLike, power: ArrayLike) -> F64:
    """The power (Z, Y, X) of each region, (REGIONS,)."""
    of = np.asarray(regions).ravel()
    inside = of >= 0
    sums = np.bincount(of[inside], np.asarray(power).ravel()[inside], REGIONS)
    return np.asarray(sums[:REGIONS], dtype=np.float64)


def gain(matrix: ArrayLike, regions: ArrayLike) -> F64:
    """What power under way in region j, which a step has added, is yet to become in a cell of i."""
    of = np.asarray(regions)
    counts = np.maximum(sums_of(of, np.ones(of.shape)), 1.0)
    return np.asarray(np.linalg.inv(np.asarray(matrix)) - np.diag(1.0 / counts))


def corrected(before: ArrayLike, stepped: ArrayLike, regions: ArrayLike, gained: F64) -> F64:
    """Power (Z, Y, X) after a step, with what later steps will bring to regions."""
    after, of = np.asarray(stepped, dtype=np.float64), np.asarray(regions)
    share = gained @ sums_of(of, after - np.asarray(before))
    return after + np.where(of >= 0, share[of], 0.0)
