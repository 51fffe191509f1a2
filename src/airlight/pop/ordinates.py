"""The light of a scene as ordinates on the device, and their phase functions as a table."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..gpu.device import Gpu
from ..gpu.layout import Struct, vec4f
from ..gpu.memory import Buffer
from ..maths.beam_phase import PHASE_TABLE, beam_phase_table
from ..maths.ordinates import Ordinates, even_sky, joined, parallel, partition
from ..scene.environment import Environment
from ..scene.lights import DirectionalLight, Light
from ..surface.sky import environment_map
from .placement import MediumPlacement


class OrdinateData(Struct):
    """One ordinate in the medium's frame."""

    direction = vec4f("of travel; w: mean cosine of the ordinate's part of the sky")
    irradiance = vec4f("rgb, in units of the table's scale")


class SceneOrdinates:
    """Sun lights and environment as ordinates in the world; made anew where they changed."""

    def __init__(self, count: int) -> None:
        self.count = count
        self._environment: Environment | None = None
        self._sky: Ordinates | None = None

    def of(self, lights: tuple[Light, ...], environment: Environment | None) -> Ordinates:
        """All ordinates; a black environment has none."""
        parts = []
        suns = [light for light in lights if isinstance(light, DirectionalLight)]
        if suns:
            parts.append(parallel([s.direction for s in suns], [s.irradiance for s in suns]))
        if environment is not self._environment:
            self._environment = environment
            self._sky = _sky(environment, self.count)
        if self._sky is not None:
            parts.append(self._sky)
        return joined(parts) if parts else parallel(np.zeros((0, 3)), np.zeros((0, 3)))


def _sky(environment: Environment | None, count: int) -> Ordinates | None:
    if environment is None or count < 1:
        return None
    if environment.map is None:  # the very sky of the furnace correction: it vanishes
        even = even_sky(count)
        light = np.asarray(environment.radiance) * environment.scale
        return replace(even, irradiance=even.irradiance * light) if light.any() else None
    radiance = environment_map(environment)
    if not radiance.max() > 0.0:
        return None
    angle = np.radians(environment.rotation_deg)
    c, s = np.cos(angle), np.sin(angle)
    about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return partition(radiance, count).turned(about_y)


class OrdinateTable:
    """The ordinates of one medium on the device.

    `scale` (W m^-2): irradiances are stored relative to the brightest, so that the range of half
    floats does not depend on the light's.
    """

    def __init__(self, gpu: Gpu, capacity: int) -> None:
        self.capacity = max(1, capacity)
        self.rows = Buffer(gpu, "ordinates", OrdinateData.dtype.itemsize * self.capacity)
        self.phase = Buffer(gpu, "phase of ordinates", 16 * PHASE_TABLE * self.capacity)
        self.scale, self.count = 1.0, 0
        self._phase_of: tuple[Any, ...] = ()

    def write(
        self, ordinates: Ordinates, placement: MediumPlacement, g: tuple[float, ...], *,
        prefilter: bool, scale: float = 0.0,
    ) -> None:  # fmt: skip
        """Upload `ordinates` (of the world) for a medium; more than the capacity are refused.

        `scale`, W m^-2: else the brightest irradiance.
        """
        if ordinates.count > self.capacity:
            raise ValueError(f"{ordinates.count} ordinates in a table of {self.capacity}")
        self.count = ordinates.count
        self.scale = scale or max(float(ordinates.irradiance.max(initial=0.0)), 1e-30)
        self.rows.write(packed_ordinates(ordinates, placement, self.scale))
        key = (ordinates.mean_cosine.tobytes(), g, prefilter)
        if key != self._phase_of:
            self._phase_of = key
            table = beam_phase_table(np.asarray(g), ordinates.mean_cosine, prefilter=prefilter)
            rgba = np.zeros((*table.shape[:2], 4), np.float32)
            rgba[..., :3] = np.minimum(table, 1e9)
            self.phase.write(rgba)

    def release(self) -> None:
        """Give the memory back."""
        self.rows.release()
        self.phase.release()


def packed_ordinates(
    ordinates: Ordinates, placement: MediumPlacement, scale: float
) -> np.ndarray[Any, np.dtype[Any]]:
    """`OrdinateData` of every ordinate."""
    packed = np.zeros(max(1, ordinates.count), OrdinateData.dtype)
    if ordinates.count:
        packed["direction"][:, :3] = placement.direction(ordinates.direction)
        packed["direction"][:, 3] = ordinates.mean_cosine
        packed["irradiance"][:, :3] = ordinates.irradiance / scale
    return packed
