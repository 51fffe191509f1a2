"""Which cells of lattices send rays in a sample: those that the rays of a view read, and others.

Only what seen cells scatter towards the eye is asked for; rays of theirs meet the light of all. So
cells out of sight send rays in the first samples, and then in turn. A few cells near the eye are in
front of most pixels, whose noise is theirs: of rays that seen cells send beside those that are
alike for all, each has a share by its solid angle from the eye.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..lattice.placement import Placement
from ..maths.arrays import F64, I64, U32
from ..maths.transforms import clip_from_view_infinite, jittered, view_from_world
from ..scene.camera import Camera

NO_POINT = 0xFFFFFFFF
"""Of a cell that sends no rays in a sample, as in `cell_sums.wgsl`."""
TURNS = 8
"""Samples in which each cell out of sight sends rays once, after the first."""
FIRST = 8
"""Samples in which all cells send rays: each brings light that was scattered once more."""
MOST = 64
"""Points of a cell: one invocation adds up the rays of all."""
READ = 2.0
"""From a cell's middle to where its light is read, on each axis, in cells: to the middle of its
neighbour, and as far as walls move that."""


class SeenCells(NamedTuple):
    """The cells (n,) uint32 that send rays, one for each point that they send them from.

    They are numbered over all lattices, the finest first; several points of a cell follow one
    another. `firsts`: of each lattice the number of its first cell, and where its cells begin in
    the list.
    """

    cells: U32
    firsts: tuple[tuple[int, int], ...]

    def points(self, count: int) -> U32:
        """The first place in the list and the number of places (count, 2) of each of `count` cells.

        NO_POINT and 0 of those that have none.
        """
        places = np.flatnonzero(np.diff(self.cells, prepend=np.uint32(NO_POINT)))
        points = np.tile(np.array([NO_POINT, 0], np.uint32), (count, 1))
        numbers = np.diff(places, append=self.cells.size)
        points[self.cells[places]] = np.stack([places, numbers], axis=1)
        return points


def seen_cells(
    placements: tuple[Placement, ...],
    camera: Camera,
    size: tuple[int, int],
    shift_px: tuple[float, float],
    turn: int | None,
    each: int = 1,
) -> SeenCells:
    """Those of nested lattices, the finest first, that an image of this `size` in pixels reads.

    `shift_px`: how far a lens moves the image; less than a pixel may be left out.
    After those of each lattice come others whose `turn` it is, as many in each one; without a
    turn all others. Where a finer lattice has all light nobody reads a cell.
    `each`: points of a cell in sight, at most and on the mean of all of them.
    """
    planes = _planes(camera, size, shift_px)
    seen, hidden, angles = [], [], []
    finer: Placement | None = None
    for placement in placements:
        is_read, is_seen = ~_are_covered(placement, finer), _are_before(placement, planes)
        seen.append(np.flatnonzero(is_read & is_seen))
        hidden.append(_in_turn(np.flatnonzero(is_read & ~is_seen), turn))
        angles.append(_solid_angles(placement, camera.position)[seen[-1]])
        finer = placement
    # Points are shared between the cells of all lattices.
    ends = np.cumsum([cells.size for cells in seen])
    numbers = np.split(numbers_of_points(np.concatenate(angles), each), ends[:-1])
    found: list[U32] = []
    firsts: list[tuple[int, int]] = []
    first = begin = 0
    for placement, cells, times, others in zip(placements, seen, numbers, hidden, strict=True):
        firsts.append((first, begin))
        found.append((first + np.append(np.repeat(cells, times), others)).astype(np.uint32))
        first, begin = first + placement.cells, begin + found[-1].size
    return SeenCells(np.concatenate(found), tuple(firsts))


def numbers_of_points(angles: F64, each: int) -> I64:
    """Of cells of these solid `angles` (n,), sr: together no more than `each` for all of them.

    Every cell has one, and of the others as its angle is, at most MOST.
    """
    others = (each - 1) * angles.size
    shares = others * angles / max(float(angles.sum()), 1e-30)
    return np.asarray(1 + np.minimum(shares, MOST - 1), np.int64)


def _in_turn(hidden: I64, turn: int | None) -> I64:
    """Of cells out of sight those whose turn it is; all without a turn."""
    if turn is None:
        return hidden
    every = turn + TURNS * np.arange(-(-hidden.size // TURNS))
    return hidden[every % max(hidden.size, 1)]


def _solid_angles(placement: Placement, position: tuple[float, float, float]) -> F64:
    """Of each cell from the eye at `position`, sr, as if it were a face across its direction."""
    eye = np.array(placement.axes) @ position
    x, y, z = ((middles - eye[k]) ** 2 for k, middles in enumerate(_middles(placement)))
    # What is nearer than a cell fills all of the image.
    area = placement.cell**2
    squared = x + y[:, None] + z[:, None, None]
    return np.asarray(area / np.maximum(squared, area), np.float64).ravel()


def _planes(camera: Camera, size: tuple[int, int], shift_px: tuple[float, float]) -> F64:
    """(5, 4): n and d of the planes that bound a view; n p + d >= 0 within."""
    look = np.subtract(camera.target, camera.position)
    view = view_from_world(camera.position, look, camera.up)
    clip = clip_from_view_infinite(np.radians(camera.fov_y_deg), size[0] / size[1], 1.0)
    x, y, _, w = jittered(clip, shift_px, size) @ view
    return np.array([w, w + x, w - x, w + y, w - y])


def _are_before(placement: Placement, planes: F64) -> NDArray[np.bool_]:
    """Whether what reads each cell may lie within all planes, in the order of cells."""
    along = planes[:, :3] @ np.array(placement.axes).T
    # A plane's distance is a sum of one term for each axis.
    is_before = np.ones(placement.count[::-1], bool)
    reach = READ * placement.cell * np.abs(along).sum(axis=1)
    for n, d, farthest in zip(along, planes[:, 3], reach, strict=True):
        x, y, z = (n[k] * middles for k, middles in enumerate(_middles(placement)))
        is_before &= x + y[:, None] + z[:, None, None] >= -d - farthest
    return is_before.ravel()


def _are_covered(placement: Placement, finer: Placement | None) -> NDArray[np.bool_]:
    """Whether each cell is read only where the next finer lattice has all light."""
    if finer is None:
        return np.zeros(placement.cells, bool)
    fade, reach = finer.borders, READ * placement.cell
    low = np.add(fade.low, fade.low_width) + reach
    high = np.subtract(fade.high, fade.high_width) - reach
    x, y, z = (
        (middles > low[k]) & (middles < high[k]) for k, middles in enumerate(_middles(placement))
    )
    return np.asarray(x & y[:, None] & z[:, None, None], bool).ravel()


def _middles(placement: Placement) -> list[F64]:
    """Where the middles of cells lie on each axis, metres along it."""
    return [
        np.asarray(low + placement.cell * (np.arange(count) + 0.5), np.float64)
        for low, count in zip(placement.origin, placement.count, strict=True)
    ]
