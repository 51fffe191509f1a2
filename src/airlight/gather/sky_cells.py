"""The environment for rays that leave the scene: cells of uniform radiance, chosen by power."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u
from ..gpu.memory import Buffer
from ..maths.colour import luminance
from ..maths.latlong import latlong_row_solid_angles
from ..maths.sampling import alias_table
from ..scene.environment import Environment
from ..surface.sky import shrunk_map
from .cells import CellPoints
from .points import Points

MILD = 16.0
"""Brightest over mean radiance up to which an environment is found by the cosine alone."""


class SkyParams(Struct):
    """The cells, the map's rotation, and how many rays there are of each kind."""

    reduced = vec2u("points")
    is_mild = u32("whether paths may find it by the cosine")
    pad = u32()
    width = u32("cells")
    height = u32("cells")
    rotation = f32("rad")
    rays = u32("of a point, by the cosine")
    sky_rays = u32("of a point, by brightness")
    first_ray = u32()


class SkyCells:
    """`buffer` holds two vec4f for each cell.

    Radiance, W m^-2 sr^-1, and the density of rays, sr^-1; the alias table's row.
    """

    def __init__(self, gpu: Gpu) -> None:
        # Until there is a sky, all of it is alike.
        self._gpu = gpu.scope()
        self._shown: Environment | None = None
        self._size = (1, 1)
        self._rotation = 0.0
        self.is_even = True
        """Whether the environment is alike everywhere, so that no ray needs a guide."""
        self.is_mild = True
        """Whether no part of it is so bright that paths would find it by luck."""
        self.buffer = Buffer(self._gpu, "sky cells", 32)

    def take(self, environment: Environment | None) -> None:
        """Show an environment."""
        # Environments are frozen: the same one is the same sky.
        if environment is self._shown:
            return
        self._shown = environment
        rows, self.is_even = cell_rows(environment)
        bright = luminance(rows[..., 0, :3])
        # A sky is mild where no part is so bright that rays find it by luck.
        self.is_mild = bool(bright.max() <= MILD * bright.mean())
        height, width = rows.shape[:2]
        self._rotation = float(np.radians(environment.rotation_deg)) if environment else 0.0
        # Of another size, the buffer is made again.
        if rows.nbytes != self.buffer.nbytes:
            self._gpu.release()
            self.buffer = Buffer(self._gpu, "sky cells", rows.nbytes)
        self._size = (width, height)
        self.buffer.write(rows)

    def count(self, rays: int) -> int:
        """Rays by brightness beside `rays` by the cosine."""
        # Half as many as by the cosine; a uniform sky needs none.
        return 0 if self.is_even else -(-rays // 2)

    def params(self, points: Points | CellPoints, rays: int, sample: int) -> SkyParams:
        """What passes over points must know of the sky; `rays` by the cosine, in this sample."""
        count = self.count(rays)
        return SkyParams(
            reduced=points.reduced,
            is_mild=int(self.is_mild),
            pad=0,
            width=self._size[0],
            height=self._size[1],
            rotation=self._rotation,
            rays=rays,
            sky_rays=count,
            first_ray=sample * count,
        )


def cell_rows(environment: Environment | None) -> tuple[NDArray[np.float32], bool]:
    """(H, W, 2, 4) float32, as `SkyCells` says, and whether all cells are equally bright."""
    if environment is None:
        return np.zeros((1, 1, 2, 4), np.float32), True
    radiance = shrunk_map(environment)
    # A uniform environment is one cell.
    if environment.map is None:
        radiance = radiance[:1, :1]
    height, width = radiance.shape[:2]
    # A cell is chosen by its power: luminance times solid angle.
    solid_angles = np.repeat(latlong_row_solid_angles(height, width)[:, None], width, axis=1)
    bright = luminance(radiance)
    power = float((bright * solid_angles).sum())
    rows = np.zeros((height, width, 2, 4), np.float32)
    # Radiance of each cell, and how dense, sr^-1, rays by brightness are there.
    rows[..., 0, :3] = radiance
    rows[..., 0, 3] = bright / max(power, 1e-300)
    # The alias table by which a ray chooses its cell.
    keep, other = alias_table((bright * solid_angles).ravel())
    rows[..., 1, 0], rows[..., 1, 1] = keep.reshape(height, width), other.reshape(height, width)
    return rows, environment.map is None or power <= 0.0
