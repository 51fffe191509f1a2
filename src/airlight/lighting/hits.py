"""Light on the surfaces that rays met: the passes that light pixels, on a texel for each ray.

Lights with their shadow maps, emitters, the lattices' irradiance and sky; diffuse light alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..area.lighting import AreaLighting
from ..gpu.commands import Commands
from ..gpu.memory import Texture
from ..lattice.irradiance import Irradiance, SkyIrradiance
from ..surface.hits import HITS, Hits
from .kit import Kit
from .lighting import LightingPasses, RadianceLayers
from .shadow_rays import ShadowRays
from .slots import NO_SUNS, Attenuation, Part


@dataclass(frozen=True)
class HitsInLight:
    """Hits, the sky's light that reaches them, and the layers that their radiance is written to."""

    hits: Hits
    layers: RadianceLayers
    sky: SkyIrradiance


class HitLighting:
    """Lights hits. `attenuation`: the media between lights and surfaces."""

    def __init__(self, kit: Kit, attenuation: Attenuation | None = None) -> None:
        self.kit, self._passes = kit, LightingPasses(kit, attenuation, HITS)
        self.shadows: ShadowRays | None = None
        """Rays that decide where shadow maps are unsure."""
        # One pass lights hits where the device binds all that it reads.
        self._is_whole = self._passes.is_one()
        self._area: AreaLighting | None = None
        if kit.area_shadows is not None:
            # Hits have no coat: of materials none is given.
            self._area = AreaLighting(kit.gpu, kit.area_shadows, (), attenuation, HITS)
        # What is near a pixel is not near a hit.
        self._no_near_field = Texture(kit.gpu, "no near field", (1, 1), "rgba32uint")

    def encode(self, commands: Commands, what: HitsInLight, irradiance: Irradiance) -> None:
        """Write the radiance of `what`; the environment's, a = 0, where a ray left the scene."""
        # Lights and lattices one after the other, where one pass would bind too much.
        if not self._is_whole:
            self.apart(commands, what, irradiance)
            return
        values = self._bound(commands, what, irradiance)
        self._draw(commands, "whole", what, what.layers.targets, values, irradiance)

    def lights(self, commands: Commands, what: HitsInLight, irradiance: Irradiance) -> Texture:
        """The texture with what lights and emitters alone give `what`."""
        values = self._bound(commands, what, irradiance)
        self._draw(commands, "lights", what, (what.layers.lit,), values, irradiance)
        return what.layers.lit

    def apart(
        self, commands: Commands, what: HitsInLight, irradiance: Irradiance
    ) -> tuple[Texture, Texture]:
        """The textures with what lights and emitters give `what`, and what `irradiance` does."""
        # Lights first, then what lattices add to them.
        values = self._bound(commands, what, irradiance)
        self._draw(commands, "lights", what, (what.layers.lit,), values, irradiance)
        values |= {"lit": what.layers.lit}
        self._draw(commands, "rest", what, what.layers.targets, values, irradiance)
        return what.layers.lit, what.layers.indirect

    def also(self, commands: Commands, what: HitsInLight, irradiance: Irradiance) -> Texture:
        """The texture with what another `irradiance` gives what `apart` has lit."""
        values = self._bound(commands, what, irradiance) | {"lit": what.layers.lit}
        targets = what.layers.direct, what.layers.also
        self._draw(commands, "rest", what, targets, values, irradiance)
        return what.layers.also

    def _draw(
        self,
        commands: Commands,
        part: Part,
        what: HitsInLight,
        targets: tuple[Texture, ...],
        values: dict[str, Any],
        irradiance: Irradiance,
    ) -> None:
        lighting = self._passes.of(part, irradiance, self.shadows)
        lighting.light(commands, targets, values, what.hits.rows)

    def _bound(
        self, commands: Commands, what: HitsInLight, irradiance: Irradiance
    ) -> dict[str, Any]:
        """The resources of lighting, by slot name."""
        # Hits have positions of their own: no camera takes part.
        hits, camera = what.hits, (np.eye(4), (0.0, 0.0, 0.0))
        # Emissive surfaces that rays hit count as a sample of their light, not by their material.
        emission = hits.emission
        if self._area is not None:
            emission = self._area.encode(commands, hits, camera, self.kit.lights.table)
        seen = self._passes.bound(
            irradiance,
            what.sky,
            self.shadows,
            world_from_clip=camera[0],
            eye=camera[1],
            size=hits.size,
            ray_start=self.shadows.raised if self.shadows else 0.0,
            # The suns that rays would meet are lights already.
            **NO_SUNS,
        )
        return seen | hits.bound | {"emission": emission, "near_field": self._no_near_field}
