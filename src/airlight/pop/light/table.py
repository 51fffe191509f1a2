"""The ordinates of one medium on the device, with their phase functions as a table."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import Any

import numpy as np

from ...gpu.device import Gpu
from ...gpu.layout import Struct, vec4f
from ...gpu.memory import Buffer
from ...maths.beam_phase import PHASE_TABLE, beam_phase_table
from ...maths.ordinates import Ordinates
from ...scene.lights import PointLight, SpotLight
from ..medium.placement import MediumPlacement
from .sky_correction import SkyCorrection

LocalLight = PointLight | SpotLight
_BLOCK_COSINE = 0.98  # mean cosine of the directions in which a cell sees a block


class Kind(IntEnum):
    """What the light of an ordinate comes from (twin: wgsl/ordinate_kind.wgsl)."""

    DISTANT = 0  # directional lights and the environment
    LOCAL = 1  # point and spot lights
    VIRTUAL = 2  # a virtual point light
    BLOCK = 3  # a block of another medium
    VIRTUAL_GRID = 4  # a virtual point light that propagates in a grid of its own


class OrdinateData(Struct):
    """One ordinate in the frame of the medium."""

    direction = vec4f("of travel, or a spot's axis; w: mean cosine of its part of the sky")
    irradiance = vec4f(
        "rgb, in units of the table's scale; of local lights W sr^-1; w: m, their spread"
    )
    position = vec4f("m; w: its Kind")
    spot = vec4f(
        "cosines of the inner and outer half angle, share of 4 pi that is lit; w: 1 for the sky's"
    )


class OrdinateTable:
    """The ordinates of one medium: distant light, local lights, then blocks of other media.

    `rows`: OrdinateData. `phase`: vec4f [ordinate][cosine], what a beam scatters into a direction.
    `scale`, W m^-2: irradiances are stored relative to the brightest, so that the range of half
    floats does not depend on that of the light. `correction`: of the sky's single scattering.
    """

    def __init__(self, gpu: Gpu, capacity: int, *, blocks: int = 0, prefilter: bool) -> None:
        """For at most `capacity` ordinates, the last `blocks` of which are other media's light.

        `prefilter`: each ordinate is spread over its part of the sky.
        """
        self.capacity, self.blocks = max(1, capacity), blocks
        self.rows = Buffer(gpu, "ordinates", OrdinateData.dtype.itemsize * self.capacity)
        self.phase = Buffer(gpu, "phase of ordinates", 16 * PHASE_TABLE * self.capacity)
        self.scale, self.count = 1.0, 0
        self.correction = SkyCorrection(gpu)
        self._prefilter = prefilter
        self._phase_of: tuple[Any, ...] = ()

    def write(
        self,
        ordinates: Ordinates,
        local: Sequence[LocalLight],
        placement: MediumPlacement,
        g: tuple[float, ...],
        scale: float = 0.0,
    ) -> None:
        """Upload the light of a frame, in world space, for a medium of mean cosine `g`.

        `scale`, W m^-2; 0: the brightest irradiance, of a local light that in its own cell. Rows of
        blocks are filled on the device. Raises ValueError for more ordinates than the capacity.
        """
        blocks = self.blocks
        self.count = ordinates.count + len(local) + blocks
        if self.count > self.capacity:
            raise ValueError(f"{self.count} ordinates in a table of {self.capacity}")
        # The unit of all stored radiances.
        near = [max(light.intensity) / float(placement.cell.max()) ** 2 for light in local]
        self.scale = scale or max(float(ordinates.irradiance.max(initial=0.0)), *near, 1e-30)
        # The rows; those of blocks know their kind alone.
        packed = packed_ordinates(ordinates, local, placement, self.scale)
        if blocks:
            rows = np.zeros(blocks, OrdinateData.dtype)
            rows["direction"][:, 3], rows["position"][:, 3] = _BLOCK_COSINE, Kind.BLOCK
            packed = np.concatenate([packed[: self.count - blocks], rows])
        self.rows.write(packed)
        self._write_phase(packed["direction"][: self.count, 3].astype(np.float64), g)

    def _write_phase(self, cosines: Any, g: tuple[float, ...]) -> None:
        """Tabulate the phase function of each ordinate, unless they are the last ones."""
        key = (cosines.tobytes(), g)
        if key == self._phase_of:
            return
        self._phase_of = key
        table = beam_phase_table(np.asarray(g), cosines, prefilter=self._prefilter)
        rgba = np.zeros((*table.shape[:2], 4), np.float32)
        rgba[..., :3] = np.minimum(table, 1e9)
        self.phase.write(rgba)


def packed_ordinates(
    ordinates: Ordinates, local: Sequence[LocalLight], placement: MediumPlacement, scale: float
) -> np.ndarray[Any, np.dtype[Any]]:
    """`OrdinateData` of every ordinate, then of every local light."""
    n = ordinates.count
    packed = np.zeros(max(1, n + len(local)), OrdinateData.dtype)
    # Distant light in the medium's frame; the sky's has a solid angle, a directional light none.
    if n:
        packed["direction"][:n, :3] = placement.direction(ordinates.direction)
        packed["direction"][:n, 3] = ordinates.mean_cosine
        packed["irradiance"][:n, :3] = ordinates.irradiance / scale
        packed["spot"][:n, 3] = ordinates.solid_angle > 0.0
    # Local lights, whose intensity falls off from a point.
    for row, light in zip(packed[n:], local, strict=False):
        # A point light is a spot without an axis, whose cone holds every direction.
        axis, spot = (0.0, 0.0, 0.0), (-2.0, -3.0, 1.0, 0.0)
        if isinstance(light, SpotLight):
            inner, outer = np.cos(np.radians([light.inner_deg, light.outer_deg]))
            axis = light.direction
            spot = (max(inner, outer + 1e-4), outer, 0.5 - 0.25 * (inner + outer), 0.0)
        row["direction"] = (*placement.direction(np.array(axis)), 1.0)
        row["irradiance"] = (*(np.array(light.intensity) / scale), light.radius)
        row["position"] = (*placement.point(np.array(light.position)), Kind.LOCAL)
        row["spot"] = spot
    return packed
