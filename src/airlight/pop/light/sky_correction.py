"""Factors that make single scattering of the sky exact in clear media; see `maths.sky_phase`."""

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
from ...scene.fingerprint import is_same
from ..medium.placement import MediumPlacement


@dataclass(frozen=True, eq=False)
class SkyLight:
    """A map (H, W, 3), W m^-2 sr^-1, its ordinates, and the rotation of both about +Y."""

    radiance: F64
    ordinates: Ordinates
    rotation_deg: float = 0.0


class SkyCorrection:
    """`texture`: factors of the beams of the sky by latitude and longitude of the direction to the
    eye; 1 until `write`. `sky_from_medium` (4, 4) rotates directions into its frame.
    """

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        # A factor of 1 for every direction, until there is a sky.
        self.texture = self._made(np.ones((1, 1, 3)))
        self.sampler = Sampler(
            gpu,
            "sky correction",
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
        """Take a sky; None leaves everything as it is."""
        if sky is None:
            return
        # The rotation of the map, which alone changes while an environment rotates.
        angle = np.radians(sky.rotation_deg)
        c, s = np.cos(angle), np.sin(angle)
        map_from_world = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
        self.sky_from_medium[:3, :3] = map_from_world @ placement.world_from_medium[:3, :3]
        # Another sky, other ordinates or another phase function need another correction.
        key = (sky.radiance, sky.ordinates, g, prefilter)
        if is_same(key, self._key):
            return
        self._key = key
        # Exact single scattering of the map over that of its ordinates.
        table = beam_phase_table(np.asarray(g), sky.ordinates.mean_cosine, prefilter=prefilter)
        factors = sky_gain(self._convolved(sky.radiance, g), sky.ordinates, table)
        if self.texture.size[:2] != (factors.shape[1], factors.shape[0]):
            self.texture.release()
            self.texture = self._made(factors)
        else:
            self.texture.write(_rgba(factors))

    def _convolved(self, radiance: F64, g: tuple[float, ...]) -> F64:
        """The map convolved with the phase function: the same for every choice of ordinates."""
        known = self._exact
        if known is None or known[0] is not radiance or known[1] != g:
            # The convolution sums over texels, and wants at least ROWS rows of them.
            repeats = -(-ROWS // len(radiance))
            wide = radiance.repeat(repeats, axis=0).repeat(repeats, axis=1)
            known = self._exact = radiance, g, convolved(wide, g)
        return known[2]

    def _made(self, factors: F64) -> Texture:
        size = (factors.shape[1], factors.shape[0])
        made = Texture(self._gpu, "sky correction", size, "rgba16float")
        made.write(_rgba(factors))
        return made


def _rgba(factors: F64) -> Any:
    texels = np.ones((*factors.shape[:2], 4), np.float16)
    texels[..., :3] = factors
    return texels
