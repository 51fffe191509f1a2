"""What makes the sky's single scattering exact, as a map on the device; see `maths.sky_phase`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...gpu.device import Gpu
from ...gpu.memory import Sampler, Texture
from ...maths.beam_phase import beam_phase_table
from ...maths.ordinates import Ordinates
from ...maths.sky_phase import ROWS, convolved, sky_gain
from ...maths.transforms import F64
from ..medium.placement import MediumPlacement


@dataclass(frozen=True, eq=False)
class SkyLight:
    """A map (H, W, 3), W m^-2 sr^-1, its ordinates, and how far both are turned about +Y."""

    radiance: F64
    ordinates: Ordinates
    rotation_deg: float = 0.0


class SkyGain:
    """`texture`, latitude and longitude: factors of the sky's beams; 1 until told otherwise."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self.texture = self._made(np.ones((1, 1, 3)))
        self.sampler = Sampler(
            gpu,
            "sky gain",
            mag_filter="linear",
            min_filter="linear",
            address_mode_u="repeat",
            address_mode_v="clamp-to-edge",
        )
        self.sky_from_medium = np.eye(4)
        self._key: tuple[Any, ...] = ()
        self._exact: tuple[F64, tuple[float, ...], F64] | None = None  # map, g, convolved

    def write(
        self,
        sky: SkyLight | None,
        placement: MediumPlacement,
        g: tuple[float, ...],
        *,
        prefilter: bool,
    ) -> None:
        """Take a sky; none leaves everything as it is."""
        if sky is None:
            return
        angle = np.radians(sky.rotation_deg)
        c, s = np.cos(angle), np.sin(angle)
        map_from_world = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
        self.sky_from_medium[:3, :3] = map_from_world @ placement.world_from_medium[:3, :3]
        key = (sky.radiance, sky.ordinates, g, prefilter)
        if len(key) == len(self._key) and all(
            a is b or (isinstance(a, tuple | bool) and a == b)
            for a, b in zip(key, self._key, strict=True)
        ):
            return
        self._key = key
        table = beam_phase_table(np.asarray(g), sky.ordinates.mean_cosine, prefilter=prefilter)
        gain = sky_gain(self._convolved(sky.radiance, g), sky.ordinates, table)
        if self.texture.size[:2] != (gain.shape[1], gain.shape[0]):
            self.texture.release()
            self.texture = self._made(gain)
        else:
            self.texture.write(_rgba(gain))

    def _convolved(self, radiance: F64, g: tuple[float, ...]) -> F64:
        """Of the map: the same for every choice of ordinates."""
        known = self._exact
        if known is None or known[0] is not radiance or known[1] != g:
            repeats = -(-ROWS // len(radiance))
            wide = radiance.repeat(repeats, axis=0).repeat(repeats, axis=1)
            known = self._exact = radiance, g, convolved(wide, g)
        return known[2]

    def _made(self, gain: F64) -> Texture:
        made = Texture(self._gpu, "sky gain", (gain.shape[1], gain.shape[0]), "rgba16float")
        made.write(_rgba(gain))
        return made


def _rgba(gain: F64) -> Any:
    texels = np.ones((*gain.shape[:2], 4), np.float16)
    texels[..., :3] = gain
    return texels
