"""The light of a scene as ordinates on the device, and their phase functions as a table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import IntEnum
from typing import Any

import numpy as np

from ...gpu.device import Gpu
from ...gpu.layout import Struct, vec4f
from ...gpu.memory import Buffer
from ...maths.beam_phase import PHASE_TABLE, beam_phase_table
from ...maths.ordinates import (
    Ordinates,
    even_sky,
    importance_sampled,
    joined,
    parallel,
    partition,
)
from ...maths.transforms import F64
from ...maths.view_ordinates import view_partition, view_samples
from ...scene.environment import Environment
from ...scene.lights import DirectionalLight, Light, PointLight, SpotLight
from ...surface.sky import environment_map
from ..medium.placement import MediumPlacement
from .sky_correction import SkyGain, SkyLight

Lamp = PointLight | SpotLight


class Kind(IntEnum):
    """What an ordinate's light comes from (twin: wgsl/ordinate_kind.wgsl)."""

    FROM_AFAR = 0
    FROM_LAMP = 1
    FROM_SURFACE = 2  # a virtual light
    FROM_MEDIUM = 3  # a block of another volume
    HOPS_ON = 4  # a virtual light in a grid of its own


class OrdinateData(Struct):
    """One ordinate in the medium's frame."""

    direction = vec4f("of travel, a lamp's axis; w: mean cosine of the ordinate's part of the sky")
    irradiance = vec4f("rgb, in units of the table's scale; a lamp's intensity, times m^-2")
    position = vec4f("m; w: its Kind")
    spot = vec4f(
        "cosines of the inner and outer half angle, share of 4 pi that is lit; w: 1 for the sky's"
    )


_BLOCK_COSINE = 0.98  # of how wide it is seen
_EVEN = np.ones((2, 4, 3))
MAKERS: dict[str, Callable[[F64, int], Ordinates]] = {
    "partition": partition,
    "importance": importance_sampled,
}
"""How a map becomes ordinates."""
_SEEN = {"partition": view_partition, "importance": view_samples}


class SceneOrdinates:
    """Sun lights and environment as ordinates in the world; made anew where they changed.

    A turned environment turns its ordinates: they are made in the map's own frame, so that nothing
    flickers while it turns. The camera has no say, unless `of` is told what it sees.
    """

    def __init__(self, count: int, made_by: str = "partition") -> None:
        """`made_by` is one of `MAKERS`."""
        self.count, self._maker, self._seen_maker = count, MAKERS[made_by], _SEEN[made_by]
        self._importance: F64 | None = None
        self._made_for: F64 | None = None
        self._environment: Environment | None = None
        self._sky: Ordinates | None = None
        self._made: tuple[Environment, SkyLight | None] | None = None
        self.sky: SkyLight | None = None  # the last one's map and ordinates, before it is turned

    def of(
        self,
        lights: tuple[Light, ...],
        environment: Environment | None,
        importance: F64 | None = None,
    ) -> Ordinates:
        """All ordinates; a black environment has none.

        `importance` (h, w) by direction towards the map, before it is turned: draws them to it.
        """
        parts = []
        suns = [light for light in lights if isinstance(light, DirectionalLight)]
        if suns:
            parts.append(parallel([s.direction for s in suns], [s.irradiance for s in suns]))
        if environment is not self._environment or importance is not self._importance:
            self._environment, self._importance = environment, importance
            self._sky = self._of_sky(environment)
        if self._sky is not None:
            parts.append(self._sky)
        return joined(parts) if parts else parallel(np.zeros((0, 3)), np.zeros((0, 3)))

    def _of_sky(self, environment: Environment | None) -> Ordinates | None:
        if environment is None or self.count < 1:
            return None
        if environment.map is None:  # the very sky of the furnace correction: it vanishes
            even = even_sky(self.count)
            light = np.asarray(environment.radiance) * environment.scale
            self.sky = even_light(even)
            return replace(even, irradiance=even.irradiance * light) if light.any() else None
        seen = self._importance
        if self._made is None or not _is_same_map(self._made[0], environment):
            radiance = environment_map(environment)
            self._made = environment, self._cut(radiance, seen) if radiance.max() > 0.0 else None
        elif self._made_for is not seen and self._made[1] is not None:
            self._made = environment, self._cut(self._made[1].radiance, seen)
        self._made_for = seen
        if self._made[1] is None:
            return None
        self.sky = replace(self._made[1], rotation_deg=environment.rotation_deg)
        straight = self.sky.ordinates
        angle = np.radians(environment.rotation_deg)
        c, s = np.cos(angle), np.sin(angle)
        about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        return straight.turned(about_y)

    def _cut(self, radiance: F64, importance: F64 | None) -> SkyLight:
        if importance is None:
            return SkyLight(radiance, self._maker(radiance, self.count))
        return SkyLight(radiance, self._seen_maker(radiance, self.count, importance))


def even_light(even: Ordinates) -> SkyLight:
    """A sky of radiance 1 everywhere and its ordinates."""
    return SkyLight(_EVEN, even)


def _is_same_map(one: Environment, other: Environment) -> bool:
    return one.map is other.map and one.scale == other.scale


def lamps_of(lights: tuple[Light, ...]) -> list[Lamp]:
    """Those of a scene's lights that are in it."""
    return [light for light in lights if isinstance(light, PointLight | SpotLight)]


class OrdinateTable:
    """The ordinates of one medium on the device: distant light, then lamps.

    `scale` (W m^-2): irradiances are stored relative to the brightest, so that the range of half
    floats does not depend on the light's.
    """

    def __init__(self, gpu: Gpu, capacity: int) -> None:
        self.capacity = max(1, capacity)
        self.rows = Buffer(gpu, "ordinates", OrdinateData.dtype.itemsize * self.capacity)
        self.phase = Buffer(gpu, "phase of ordinates", 16 * PHASE_TABLE * self.capacity)
        self.scale, self.count = 1.0, 0
        self.gain = SkyGain(gpu)
        self._phase_of: tuple[Any, ...] = ()

    def write(
        self,
        ordinates: Ordinates,
        lamps: Sequence[Lamp],
        placement: MediumPlacement,
        g: tuple[float, ...],
        *,
        prefilter: bool,
        scale: float = 0.0,
        blocks: int = 0,
    ) -> None:
        """Upload light (of the world) for a medium; more than the capacity is refused.

        The last `blocks` rows are other media's light, written on the device.

        `scale`, W m^-2: else the brightest irradiance, of a lamp that in its own cell.
        """
        self.count = ordinates.count + len(lamps) + blocks
        if self.count > self.capacity:
            raise ValueError(f"{self.count} ordinates in a table of {self.capacity}")
        near = [max(lamp.intensity) / float(placement.cell.max()) ** 2 for lamp in lamps]
        self.scale = scale or max(float(ordinates.irradiance.max(initial=0.0)), *near, 1e-30)
        packed = packed_ordinates(ordinates, lamps, placement, self.scale)
        if blocks:
            rows = np.zeros(blocks, OrdinateData.dtype)
            rows["direction"][:, 3], rows["position"][:, 3] = _BLOCK_COSINE, Kind.FROM_MEDIUM
            packed = np.concatenate([packed[: self.count - blocks], rows])
        self.rows.write(packed)
        cosines = packed["direction"][: self.count, 3].astype(np.float64)
        key = (cosines.tobytes(), g, prefilter)
        if key != self._phase_of:
            self._phase_of = key
            table = beam_phase_table(np.asarray(g), cosines, prefilter=prefilter)
            rgba = np.zeros((*table.shape[:2], 4), np.float32)
            rgba[..., :3] = np.minimum(table, 1e9)
            self.phase.write(rgba)


def packed_ordinates(
    ordinates: Ordinates, lamps: Sequence[Lamp], placement: MediumPlacement, scale: float
) -> np.ndarray[Any, np.dtype[Any]]:
    """`OrdinateData` of every ordinate, then of every lamp."""
    n = ordinates.count
    packed = np.zeros(max(1, n + len(lamps)), OrdinateData.dtype)
    if n:
        packed["direction"][:n, :3] = placement.direction(ordinates.direction)
        packed["direction"][:n, 3] = ordinates.mean_cosine
        packed["irradiance"][:n, :3] = ordinates.irradiance / scale
        packed["spot"][:n, 3] = ordinates.solid_angle > 0.0
    for row, lamp in zip(packed[n:], lamps, strict=False):
        axis, spot = (0.0, 0.0, 0.0), (-2.0, -3.0, 1.0, 0.0)
        if isinstance(lamp, SpotLight):
            inner, outer = np.cos(np.radians([lamp.inner_deg, lamp.outer_deg]))
            axis = lamp.direction
            spot = (max(inner, outer + 1e-4), outer, 0.5 - 0.25 * (inner + outer), 0.0)
        row["direction"] = (*placement.direction(np.array(axis)), 1.0)
        row["irradiance"][:3] = np.array(lamp.intensity) / scale
        row["position"] = (*placement.point(np.array(lamp.position)), Kind.FROM_LAMP)
        row["spot"] = spot
    return packed
