"""Light solved on a lattice or in a volume, as arrays, with the shaders' lookup in NumPy.

Radiance is stored in two bands, L(w) = a + b.w, W m^-2 sr^-1, with w the direction of travel.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..maths.lattice6 import surface_irradiance

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

AXES: F64 = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
"""Normals of an ambient cube's six values."""
WHOLE_BEFORE = 0.75
"""As in wgsl/lattice_space.wgsl: cells before a surface where the walls beside it are looked up."""
BEFORE = 0.15
"""As in wgsl/lattice.wgsl: cells before a surface where the walls that it faces are looked up."""
CREVICE_SHARE = 0.5
"""As in wgsl/lattice.wgsl: the least share of the light in the next cell that a surface gets."""


@dataclass(frozen=True, eq=False)
class LatticeLight:
    """Cubic cells of side `cell`, m; cell (i, j, k) spans origin + cell * [i, i+1] ...

    axes       (3, 3) unit vectors of the world, in rows, along which the cells lie. All else is
               along them: `axes @ p` is a point p as origin and fade have it, and bx, by, bz are
               components along them
    fade       (4, 3) m: where its light begins, over which width, where it ends, over which width
    surfaces   (Z, Y, X, 3, 4) the light that surfaces get: (a, bx, by, bz) for R, G, B
    air        the same for the light that air scatters, or None: J(w) = sigma_s (a + g b.w)
    openness   (Z, Y, X, 6) how open the faces at -x +x -y +y -z +z are, both ways
    walls      (Z, Y, X, 3) how far, in cells, the wall that was counted on the cell's low x, y, z
               face really lies from it
    dead_ends  (Z, Y, X) bits of the hops +x -x +y -y +z -z that leave the cell into a wall with air
               before it: what faces such a wall is not looked up behind it. None: no such walls
    rule       how surfaces read it; "lobe": as a lobe that is nowhere negative, "linear": as
               pi (a - 2/3 b.n), at least 0
    """

    origin: tuple[float, float, float]
    cell: float
    fade: F64
    surfaces: F32
    openness: F32
    walls: F32
    air: F32 | None = None
    dead_ends: NDArray[np.uint8] | None = None
    rule: Literal["lobe", "linear"] = "lobe"
    axes: F64 = field(default_factory=lambda: np.eye(3))

    @property
    def count(self) -> tuple[int, int, int]:
        """Cells along x, y, z."""
        z, y, x = self.surfaces.shape[:3]
        return x, y, z

    def irradiance(self, points: ArrayLike, normals: ArrayLike) -> F64:
        """(n, 3), W m^-2, of indirect light on surfaces at `points` (n, 3), m.

        `normals` (n, 3) are unit vectors.
        """
        # As lattice_irradiance of wgsl/lattice.wgsl does.
        p, n = self._own(points), self._own(normals)
        coordinates = self._bent(p, n)
        uvw = self._eased(self._lookup_coordinates(coordinates, n), _rim_shares(n))
        here = self._facing(uvw, n)
        next_cell = self._facing(uvw + n / np.array(self.count), n)
        return np.maximum(here, CREVICE_SHARE * next_cell)

    def weight(self, points: ArrayLike) -> F64:
        """(n,): 1 inside, falling to 0 towards the border. Twin: lattice_weight."""
        p = self._own(points)
        low, low_width, high, high_width = self.fade
        inside = np.minimum((p - low) / low_width, (high - p) / high_width).min(axis=1)
        return np.asarray(np.clip(inside, 0.0, 1.0))

    def ambient_cubes(self) -> F32:
        """(Z, Y, X, 6, 3), W m^-2: irradiance in every cell on surfaces that face AXES,
        which are the lattice's own.
        """
        states = self.surfaces[..., None, :, :]  # (Z, Y, X, 1, 3, 4)
        return self._read(states, AXES[:, None, :]).astype(np.float32)

    def _own(self, vectors: ArrayLike) -> F64:
        """Points or normals (n, 3) of the world along our axes. Twin: lattice_from_world."""
        return np.asarray(np.asarray(vectors, np.float64) @ self.axes.T)

    def _facing(self, uvw: F64, n: F64) -> F64:
        return self._read(_trilinear(self.surfaces, uvw), n[:, None, :])

    def _read(self, states: NDArray[Any], n: F64) -> F64:
        if self.rule == "lobe":
            return surface_irradiance(states, n, 1.0, scale=1.0)
        along = (states[..., 1:] * n).sum(axis=-1)
        return np.asarray(np.pi * np.maximum(states[..., 0] - 2.0 / 3.0 * along, 0.0), np.float64)

    def _cells(self, coordinates: F64) -> tuple[NDArray[np.intp], tuple[Any, Any, Any]]:
        """The cell (n, 3) of each lattice coordinate, and its index in the arrays."""
        cell = np.clip(np.floor(coordinates), 0, np.array(self.count) - 1).astype(np.intp)
        return cell, (cell[:, 2], cell[:, 1], cell[:, 0])

    def _lookup_coordinates(self, coordinates: F64, n: F64) -> F64:
        """Twin: lookup_coordinates in wgsl/lattice.wgsl."""
        if self.dead_ends is None:
            return coordinates + _raised(coordinates, n)
        coordinates = self._lifted(coordinates, n)
        wanted = coordinates + _raised(coordinates, n)
        cell = np.floor(coordinates + BEFORE * n)
        within = np.where(n < 0.0, np.maximum(wanted, cell + 0.5), np.minimum(wanted, cell + 0.5))
        return np.where(self._ends(cell, n), within, wanted)

    def _lifted(self, coordinates: F64, n: F64) -> F64:
        """Twin: lifted in wgsl/lattice.wgsl."""
        is_facing = np.abs(n) > 0.5
        before = coordinates + np.where(is_facing, 0.5 * np.sign(n), 0.0)
        cell = np.floor(before)
        t = before - cell
        side = np.where(t > 1.0 - BEFORE, 1.0, 0.0) - np.where(t < BEFORE, 1.0, 0.0)
        step = np.where(is_facing, 0.0, side)
        is_above = self._ends(cell, step)
        is_below = self._ends(cell + step, -step) & ~is_above
        lifted = cell + 0.5 + 0.5 * step + (BEFORE + 0.01) * np.where(is_below, step, -step)
        return np.where((is_above | is_below) & (step != 0.0), lifted, coordinates)

    def _ends(self, cell: F64, step: F64) -> NDArray[np.bool_]:
        """(n, 3): the axes along which `directions` from cells lead into an enclosed face.

        Twin: ends in wgsl/lattice.wgsl.
        """
        assert self.dead_ends is not None
        _, at = self._cells(cell)
        hop = 2 * np.arange(3) + (step < 0.0)
        return np.asarray((self.dead_ends[at][:, None].astype(np.intp) >> hop) & 1 == 1)

    def _bent(self, p: F64, n: F64) -> F64:
        """Twin: warped_surface_coordinates in wgsl/lattice_space.wgsl."""
        coordinates = (p - np.array(self.origin)) / self.cell
        return np.stack([self._warped_axis(coordinates, n, axis) for axis in range(3)], axis=1)

    def _warped_axis(self, coordinates: F64, n: F64, axis: int) -> F64:
        """One axis, between the walls of the cell WHOLE_BEFORE cells in front of the surface."""
        beyond = WHOLE_BEFORE * n
        beyond[:, axis] = 0.0
        cell, at = self._cells(coordinates + beyond)
        low, high = self.walls[at][:, axis].astype(np.float64), self._wall_above(cell, axis)
        t = coordinates[:, axis] - cell[:, axis]
        between = (t - low) / np.maximum(1.0 + high - low, 0.25)
        below, above = (t - low) / (1.0 + low), 1.0 + (t - 1.0 - high) / (1.0 - high)
        bent = np.where(t < low, below, np.where(t > 1.0 + high, above, between))
        return np.asarray(cell[:, axis] + bent)

    def _wall_above(self, cell: NDArray[np.intp], axis: int) -> F64:
        """The shift of the wall on the high face along `axis`; 0 at the lattice's end."""
        last = self.count[axis] - 1
        x, y, z = (np.minimum(cell[:, k] + (k == axis), self.count[k] - 1) for k in range(3))
        return np.where(cell[:, axis] == last, 0.0, self.walls[z, y, x, axis])

    def _eased(self, coordinates: F64, rim: F64) -> F64:
        """Twin: lattice_eased in wgsl/lattice.wgsl; `rim` (n, 3) as from `_rim_shares`."""
        cell, at = self._cells(coordinates)
        t = np.clip(coordinates - cell, 0.0, 1.0) - 0.5
        open_shares = self.openness[at].reshape(-1, 3, 2).astype(np.float64)
        share = np.where(t > 0.0, open_shares[..., 1], open_shares[..., 0])
        within = rim * _smoothstep(0.0, 0.25, share) * _smoothstep(0.5 - BEFORE, 0.5, np.abs(t))
        count = np.array(self.count)
        eased = cell + 0.5 + t * np.maximum(_smoothstep(0.15, 0.5, share), within)
        return np.asarray(np.clip(eased, 0.5, count - 0.5) / count)


@dataclass(frozen=True, eq=False)
class VolumeLight:
    """The radiance that a volume scatters towards `eye` (world, m).

    `radiance` (Z, Y, X, 3), W m^-2 sr^-1: times sigma_s it is J in W m^-3 sr^-1. Its cells fill the
    unit cube (x, y, z), which `world_from_unit` (4, 4) maps to the world.
    """

    radiance: F32
    world_from_unit: F64
    eye: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class LightField:
    """All light that a technique solved: nested lattices, the finest first, and volumes.

    `technique` and `scene` are their names.
    """

    technique: str
    scene: str
    lattices: tuple[LatticeLight, ...] = ()
    volumes: tuple[VolumeLight, ...] = ()

    def irradiance(self, points: ArrayLike, normals: ArrayLike) -> F64:
        """(n, 3), W m^-2, of indirect light on surfaces at `points` (n, 3), m.

        Each lattice fades into the next coarser one, the last into nothing. `normals` (n, 3) are
        unit vectors.
        """
        p = np.asarray(points, np.float64)
        total, left = np.zeros(p.shape), np.ones(len(p))
        for lattice in self.lattices:
            share = left * lattice.weight(p)
            total += share[:, None] * lattice.irradiance(p, normals)
            left -= share
        return total

    def save(self, path: Any) -> None:
        """Write `path`: an .npz, a folder, or a .vdb, which `load` does not read again.

        Raises OutputError.
        """
        if str(path).endswith(".vdb"):
            from .vdb import save_light_vdb

            save_light_vdb(self, path)
            return
        from .light_field_file import save_light_field

        save_light_field(self, path)

    @staticmethod
    def load(path: Any) -> LightField:
        """Read what `save` wrote to `path`: a .npz file or a folder. Raises SceneError."""
        from .light_field_file import load_light_field

        return load_light_field(path)


def _smoothstep(low: float, high: float, x: F64) -> F64:
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def _rim_shares(n: F64) -> F64:
    """Twin: rim_shares in wgsl/lattice.wgsl, of unit normals."""
    return 1.0 - _smoothstep(0.2, 0.5, np.abs(n))


def _raised(coordinates: F64, n: F64) -> F64:
    """The offset before a surface, in cells. Twin: lookup_offset in wgsl/lattice.wgsl."""
    along = coordinates * np.sign(n)
    f = along - np.floor(along)
    return np.asarray(n * (0.5 + np.minimum(f, 1.0 - f)))


def _trilinear(cells: F32, uvw: F64) -> F64:
    """Values (n, ...) of cells (Z, Y, X, ...) at texture coordinates (n, 3), edges clamped."""
    count = np.array(cells.shape[2::-1])
    texel = uvw * count - 0.5
    low = np.floor(texel)
    t = texel - low
    total = np.zeros((len(uvw), *cells.shape[3:]))
    for corner in np.ndindex(2, 2, 2):
        x, y, z = np.clip(low + corner, 0, count - 1).astype(np.intp).T
        weight = np.prod(np.where(corner, t, 1.0 - t), axis=1)
        total += weight.reshape(-1, *[1] * (cells.ndim - 3)) * cells[z, y, x]
    return total
