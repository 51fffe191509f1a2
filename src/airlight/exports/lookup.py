"""Where a surface is looked up in an exported lattice, as the shaders do it.

Twins of wgsl/lattice.wgsl and wgsl/lattice_space.wgsl, which a test holds together.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import F64
from ..maths.transforms import smoothstep

if TYPE_CHECKING:
    from .light_field import LatticeLight


WHOLE_BEFORE = 0.75
"""As in wgsl/lattice_space.wgsl: cells before a surface where the walls beside it are looked up."""
BEFORE = 0.15
"""As in wgsl/lattice.wgsl: cells before a surface where the walls that it faces are looked up."""
BEFORE_OBLIQUE = 0.75
"""As in wgsl/lattice.wgsl: cells before an oblique surface where it is looked up."""
BEHIND_PLANE, BEFORE_PLANE = -0.1, 0.3
"""As in wgsl/lattice.wgsl: how far from an oblique surface's plane, cells, others lie behind it and
before it."""
LEAST_BEFORE = 1e-4
"""As in wgsl/lattice.wgsl: what cells behind it count, for points of which none is before it."""
OBLIQUE, CUT = (0.9903, 0.9986), (0.05, 0.14)
"""As in wgsl/obliqueness.wgsl: cosines between which surfaces along an axis become oblique to it;
as in wgsl/lattice_space.wgsl: sines from which on their planes cut others."""
OWN_STEPS = (0.2, 0.4)
"""As in wgsl/surface_coordinates.wgsl: sines between a plane and an axis from which on closed faces
across it are the plane's own steps."""
WHOLE_CELL = (0.35, 0.6)
"""As in wgsl/surface_coordinates.wgsl: cells from an oblique plane to the middle of one that lies
wholly before it."""
BESIDE_PLANE, OF_PLANE, ON_PLANE = (1.0, 1.5), (0.7, 0.9), 0.004
"""As in wgsl/surface_coordinates.wgsl: cells from an oblique plane within which what stands beside
it is looked up before it; cosines from which on that is a part of it; what rounding may hide."""


class _Plane(NamedTuple):
    """Oblique planes: a point (n, 3) of each, unit normals, and how far faces of cells closed
    across each axis are their own (n, 3); whether they bound a body (n, 1)."""

    point: F64
    normal: F64
    is_own: F64
    is_body: NDArray[np.bool_]

    def distance(self, cell: F64) -> F64:
        """(n, 1), cells: how far the middles of cells (n, 3) are before the planes."""
        return np.asarray(((cell + 0.5 - self.point) * self.normal).sum(axis=1, keepdims=True))

    def whole(self, cell: F64) -> F64:
        """(n, 1): how far all of a cell is before the plane."""
        return smoothstep(*WHOLE_CELL, self.distance(cell))


class Lookup:
    """Texture coordinates of surfaces in one lattice."""

    def __init__(self, lattice: LatticeLight) -> None:
        self.count, self.cell, self.origin = lattice.count, lattice.cell, lattice.origin
        self.openness, self.walls, self.planes = lattice.openness, lattice.walls, lattice.planes
        self.dead_ends, self.rule = lattice.dead_ends, lattice.rule

    def coordinates(self, p: F64, n: F64) -> F64:
        """Texture coordinates (n, 3) for surfaces at `p` (n, 3), metres, of normals `n` (n, 3).

        Both are along the lattice's axes. Twin: lattice_coordinates in
        wgsl/surface_coordinates.wgsl.
        """
        # Warped to the walls, then before the surface, then away from closed faces.
        warped = self.warped(p, n)
        at = self._lookup_coordinates(warped, n)
        upright = self._eased(at, _rim_shares(n))
        if self.rule == "linear":
            return upright

        # Surfaces that lie along no axis are looked up between cells before their plane, and others
        # before that of an oblique one beside them.
        oblique = 1.0 - smoothstep(*OBLIQUE, np.abs(n).max(axis=1, keepdims=True))
        plane = self._plane_coordinates(p, warped, n)
        own = upright + oblique * (self._oblique_coordinates(plane, n) - upright)
        if self.planes is None:
            return own
        beside = self._coordinates_beside(self.planes, p, at, n, upright)
        return np.where(oblique > 0.0, own, beside)

    def _cells(self, coordinates: F64) -> tuple[NDArray[np.intp], tuple[Any, Any, Any]]:
        """The cell (n, 3) of each lattice coordinate, and its index in the arrays."""
        cell = np.clip(np.floor(coordinates), 0, np.array(self.count) - 1).astype(np.intp)
        return cell, (cell[:, 2], cell[:, 1], cell[:, 0])

    def _plane_coordinates(self, p: F64, warped: F64, n: F64) -> F64:
        """Twin: plane_coordinates in wgsl/lattice_space.wgsl."""
        # As it is where the plane cuts the axis, else between walls.
        coordinates = (p - np.array(self.origin)) / self.cell
        return np.asarray(warped + smoothstep(*CUT, np.abs(n)) * (coordinates - warped))

    def _oblique_coordinates(self, plane: F64, n: F64) -> F64:
        """Before its own_plane of wgsl/surface_coordinates.wgsl."""
        own = _Plane(plane, n, smoothstep(*OWN_STEPS, np.abs(n)), np.zeros((len(n), 1), np.bool_))
        base = self._lifted(plane, n)
        return self._coordinates_before(base, base + BEFORE_OBLIQUE * n, own)

    def _coordinates_before(self, base: F64, raised: F64, plane: _Plane) -> F64:
        """Twin: coordinates_before in wgsl/surface_coordinates.wgsl."""
        # From a point before the surface, not past walls that are not its own.
        count, n, is_own = np.array(self.count), plane.normal, plane.is_own
        walled = self._before_walls(base, raised, n)
        passes = np.where(plane.is_body, 0.0, 1.0 - plane.whole(np.floor(base + BEFORE * n)))
        at = np.clip(walled + is_own * passes * (raised - walled), 0.5, count - 0.5)
        # No nearer to closed faces than they allow.
        cell = np.floor(at)
        t = at - cell - 0.5
        ended = np.where(plane.is_body, self._ends(cell, n), plane.whole(cell))
        passes = is_own * (1.0 - np.where(t * n > 0.0, ended, 0.0))
        eased = self._open_offset(cell, t, np.zeros_like(t))
        offset = eased + passes * (t - eased)
        # On each axis, the share of all cells that are beside the point's own along it.
        shares = _shares_before(plane.distance(cell)[:, 0], offset, n)
        beside = [np.take(shares, 1, axis=1 + axis).sum(axis=(1, 2)) for axis in range(3)]
        share = np.stack(beside, axis=1) / shares.sum(axis=(1, 2, 3))[:, None]
        middle = cell + 0.5 + np.sign(offset) * share
        return np.asarray(np.clip(middle, 0.5, count - 0.5) / count)

    def _coordinates_beside(self, planes: NDArray[Any], p: F64, at: F64, n: F64, uvw: F64) -> F64:
        """Before its plane_beside of wgsl/surface_coordinates.wgsl."""
        # The plane that the cell knows where the surface is looked up.
        is_facing = np.abs(n) > 0.5
        own = (p - np.array(self.origin)) / self.cell
        cell, index = self._cells(np.where(is_facing, at, own))
        stored = planes[index].astype(np.float64)
        size = np.linalg.norm(stored[:, :3], axis=1, keepdims=True)
        is_thin = size > 1.5
        towards = stored[:, :3] / np.maximum(size, 1e-30)
        on_plane = cell + 0.5 - stored[:, 3:] * towards
        height = ((own - on_plane) * towards).sum(axis=1, keepdims=True)
        m = np.where(height >= -ON_PLANE, 1.0, -1.0) * towards
        # As far before it as it is itself looked up, along the surface.
        is_own = np.where(is_facing, 0.0, smoothstep(*OWN_STEPS, np.abs(m)))
        base = np.where(is_facing, at, self._plane_coordinates(p, at, m))
        raised = base + np.maximum(BEFORE_OBLIQUE - np.abs(height), 0.0) * np.where(is_facing, 0, m)
        beside = self._coordinates_before(base, raised, _Plane(on_plane, m, is_own, ~is_thin))
        is_near = 1.0 - smoothstep(*BESIDE_PLANE, np.abs(height))
        along = np.abs((m * n).sum(axis=1, keepdims=True))
        share = (size - 2.0 * is_thin) * is_near * (1.0 - smoothstep(*OF_PLANE, along))
        return np.asarray(uvw + share * (beside - uvw))

    def _lookup_coordinates(self, coordinates: F64, n: F64) -> F64:
        """Twin: lookup_coordinates in wgsl/lattice.wgsl."""
        # The lookup moves ahead of the surface, but not past the middle of a cell whose far face is
        # enclosed.
        coordinates = self._lifted(coordinates, n)
        wanted = coordinates + _raised(coordinates, n)
        return self._before_walls(coordinates, wanted, n)

    def _before_walls(self, coordinates: F64, wanted: F64, n: F64) -> F64:
        """Twin: before_walls in wgsl/lattice.wgsl."""
        cell = np.floor(coordinates + BEFORE * n)
        within = np.where(n < 0.0, np.maximum(wanted, cell + 0.5), np.minimum(wanted, cell + 0.5))
        return np.where(self._ends(cell, n), within, wanted)

    def _lifted(self, coordinates: F64, n: F64) -> F64:
        """Twin: lifted in wgsl/lattice.wgsl."""
        # Asked is the cell in front of the surface, and which of its faces, if any, lies within
        # BEFORE of the point.
        is_facing = np.abs(n) > 0.5
        before = coordinates + np.where(is_facing, 0.5 * np.sign(n), 0.0)
        cell = np.floor(before)
        t = before - cell
        side = np.where(t > 1.0 - BEFORE, 1.0, 0.0) - np.where(t < BEFORE, 1.0, 0.0)
        # Along a face that is enclosed, light on the far side must not be mixed in.
        step = np.where(is_facing, 0.0, side)
        # The rim of a wall is seen from either side: the enclosed face may be this cell's or its
        # neighbour's.
        is_above = self._ends(cell, step)
        is_below = self._ends(cell + step, -step) & ~is_above
        lifted = cell + 0.5 + 0.5 * step + (BEFORE + 0.01) * np.where(is_below, step, -step)
        return np.where((is_above | is_below) & (step != 0.0), lifted, coordinates)

    def _ends(self, cell: F64, step: F64) -> NDArray[np.bool_]:
        """(n, 3): the axes along which `directions` from cells lead into an enclosed face.

        Twin: ends in wgsl/lattice.wgsl.
        """
        if self.dead_ends is None:
            return np.zeros(step.shape, np.bool_)

        # Hops are numbered +x -x +y -y +z -z.
        _, at = self._cells(cell)
        hop = 2 * np.arange(3) + (step < 0.0)
        return np.asarray((self.dead_ends[at][:, None].astype(np.intp) >> hop) & 1 == 1)

    def warped(self, p: F64, n: F64) -> F64:
        """Twin: warped_lookup in wgsl/lattice_space.wgsl."""
        # Again where that takes a point out from behind one of the walls of a corner.
        coordinates = (p - np.array(self.origin)) / self.cell
        warped = self._warped_between(coordinates, coordinates, n)
        again, cell = self._warped_between(coordinates, warped, n), np.floor(coordinates)
        comes_out = (np.floor(warped) == cell) & (np.floor(again) != cell)
        return np.where(comes_out, again, warped)

    def _warped_between(self, coordinates: F64, others: F64, n: F64) -> F64:
        """Twin: warped_between in wgsl/lattice_space.wgsl."""
        axes = (self._warped_axis(coordinates, others, n, axis) for axis in range(3))
        return np.stack(list(axes), axis=1)

    def _warped_axis(self, coordinates: F64, others: F64, n: F64, axis: int) -> F64:
        """One axis, between the walls of the cell WHOLE_BEFORE cells in front of the surface."""
        # Walls are those in front of the surface, because behind it lies another room.
        beyond = others + WHOLE_BEFORE * n
        beyond[:, axis] = coordinates[:, axis]
        cell, at = self._cells(beyond)
        low, high = self.walls[at][:, axis].astype(np.float64), self._wall_above(cell, axis)
        # Linear between both walls, and beyond each of them, so that walls lie on faces.
        t = coordinates[:, axis] - cell[:, axis]
        between = (t - low) / np.maximum(1.0 + high - low, 0.25)
        below, above = (t - low) / (1.0 + low), 1.0 + (t - 1.0 - high) / (1.0 - high)
        bent = np.where(t < low, below, np.where(t > 1.0 + high, above, between))
        return np.asarray(cell[:, axis] + bent)

    def _wall_above(self, cell: NDArray[np.intp], axis: int) -> F64:
        """The shift of the wall on the high face along `axis`; 0 at the lattice's end."""
        # A wall on a high face is the low wall of the next cell.
        last = self.count[axis] - 1
        x, y, z = (np.minimum(cell[:, k] + (k == axis), self.count[k] - 1) for k in range(3))
        return np.where(cell[:, axis] == last, 0.0, self.walls[z, y, x, axis])

    def _eased(self, coordinates: F64, rim: F64) -> F64:
        """Twin: lattice_eased in wgsl/lattice.wgsl; `rim` (n, 3) as from `_rim_shares`."""
        # Towards the middle of the cell where its face is closed.
        cell, _ = self._cells(coordinates)
        t = np.clip(coordinates - cell, 0.0, 1.0) - 0.5
        eased = cell + 0.5 + self._open_offset(cell, t, rim)
        return np.asarray(np.clip(eased, 0.5, np.array(self.count) - 0.5) / np.array(self.count))

    def _open_offset(self, cell: NDArray[Any], t: F64, rim: F64) -> F64:
        """Twin: open_offset in wgsl/lattice.wgsl."""
        _, at = self._cells(np.asarray(cell, np.float64))
        # Linear where the face is open, the cell's own value where it is closed: no light leaks
        # through a wall.
        open_shares = self.openness[at].reshape(-1, 3, 2).astype(np.float64)
        share = np.where(t > 0.0, open_shares[..., 1], open_shares[..., 0])
        within = rim * smoothstep(0.0, 0.25, share) * smoothstep(0.5 - BEFORE, 0.5, np.abs(t))
        return np.asarray(t * np.maximum(smoothstep(0.15, 0.5, share), within))


def _rim_shares(n: F64) -> F64:
    """Twin: rim_shares in wgsl/lattice.wgsl, of unit normals."""
    return 1.0 - smoothstep(0.2, 0.5, np.abs(n))


def _raised(coordinates: F64, n: F64) -> F64:
    """The offset before a surface, in cells. Twin: lookup_offset in wgsl/lattice.wgsl."""
    # Half a cell from where cells meet, a whole one from the middle of a cell.
    along = coordinates * np.sign(n)
    f = along - np.floor(along)
    return np.asarray(n * (0.5 + np.minimum(f, 1.0 - f)))


def _shares_before(distance: F64, offset: F64, n: F64) -> F64:
    """(n, 2, 2, 2): shares of the eight cells around points, as far as they are before a plane.

    An index is 1 where a cell is beside the point's own along that axis. Twin: shares_before in
    wgsl/surface_coordinates.wgsl.
    """
    # Linear between them, less where their own middles are near the plane or behind it.
    step, t = np.sign(offset) * n, np.abs(offset)
    shares = np.empty((len(n), 2, 2, 2))
    for beside in np.ndindex(2, 2, 2):
        linear = np.prod(np.where(beside, t, 1.0 - t), axis=1)
        own = distance + step @ np.array(beside)
        before = smoothstep(BEHIND_PLANE, BEFORE_PLANE, own) + LEAST_BEFORE
        shares[:, *beside] = linear * before
    return shares
