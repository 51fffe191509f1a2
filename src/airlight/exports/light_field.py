"""Light solved on a lattice or in a volume, as arrays, with the shaders' lookup in NumPy.

Radiance is stored in two bands, L(w) = a + b.w, W m^-2 sr^-1, with w the direction of travel.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..maths.arrays import F32, F64
from ..maths.lattice6 import surface_irradiance
from .lookup import Lookup

AXES: F64 = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
"""Normals of an ambient cube's six values."""
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
    planes     (Z, Y, X, 4) the oblique surface that each cell is near: its unit normal times how
               far it counts, plus 2 on a thin board; cells from it to the cell's middle. Or None
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
    planes: F32 | None = None
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
        uvw = Lookup(self).coordinates(p, n)
        here = self._facing(uvw, n)
        next_cell = self._facing(uvw + n / np.array(self.count), n)
        return np.maximum(here, CREVICE_SHARE * next_cell)

    def weight(self, points: ArrayLike) -> F64:
        """(n,): 1 inside, falling to 0 towards the border. Twin: lattice_weight."""
        p = self._own(points)

        # As the shader has it: rising over a width at the low side, falling at the high one.
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
        # A lobe that is nowhere negative, or the two bands as they are.
        if self.rule == "lobe":
            return surface_irradiance(states, n, 1.0, scale=1.0)
        along = (states[..., 1:] * n).sum(axis=-1)
        return np.asarray(np.pi * np.maximum(states[..., 0] - 2.0 / 3.0 * along, 0.0), np.float64)


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
        # What a finer lattice leaves of a point is the next one's.
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


def _trilinear(cells: F32, uvw: F64) -> F64:
    """Values (n, ...) of cells (Z, Y, X, ...) at texture coordinates (n, 3), edges clamped."""
    # Texels lie in the middle of cells, as a sampler reads them.
    count = np.array(cells.shape[2::-1])
    texel = uvw * count - 0.5
    low = np.floor(texel)
    t = texel - low
    # Eight corners, each weighted by the volume of the box opposite to it.
    total = np.zeros((len(uvw), *cells.shape[3:]))
    for corner in np.ndindex(2, 2, 2):
        x, y, z = np.clip(low + corner, 0, count - 1).astype(np.intp).T
        weight = np.prod(np.where(corner, t, 1.0 - t), axis=1)
        total += weight.reshape(-1, *[1] * (cells.ndim - 3)) * cells[z, y, x]
    return total
