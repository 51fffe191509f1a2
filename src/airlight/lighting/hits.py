"""Light on the surfaces that rays met: the passes that light pixels, on a texel for each ray.

Lights with their shadow maps, emitters, the lattices' irradiance and sky; diffuse light alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..area.lighting import AreaLighting
from ..gpu.commands import Commands
from ..gpu.demands import fits
from ..gpu.memory import Texture, linear_sampler
from ..lattice.irradiance import Irradiance, SkyIrradiance
from ..surface.hits import HITS, Hits
from .kernel import Emitters, LatticeLight
from .kit import Kit
from .lighting import Lighting, RadianceLayers
from .shadow_rays import ShadowRays, shadow_key
from .slots import NO_SUNS, Attenuation, LightingParams, Part, lighting_slots


@dataclass(frozen=True)
class HitsInLight:
    """Hits, the sky's light that reaches them, and the layers that their radiance is written to."""

    hits: Hits
    layers: RadianceLayers
    sky: SkyIrradiance


class HitLighting:
    """Lights hits. `attenuation`: the media between lights and surfaces."""

    def __init__(self, kit: Kit, attenuation: Attenuation | None = None) -> None:
        self.kit, self.gpu, self.attenuation = kit, kit.gpu, attenuation
        self._passes: dict[tuple[Any, ...], Lighting] = {}
        self.shadows: ShadowRays | None = None
        """Rays that decide where shadow maps are unsure."""
        # One pass lights hits where the device binds all that it reads.
        has_panes = kit.meshes.has_translucent
        slots = lighting_slots("whole", attenuation, points=HITS, has_panes=has_panes)
        self._is_whole = fits(kit.gpu, slots)
        self._area: AreaLighting | None = None
        if kit.area_shadows is not None:
            # Hits have no coat: of materials none is given.
            self._area = AreaLighting(kit.gpu, kit.area_shadows, (), attenuation, HITS)
        self._linear = linear_sampler(kit.gpu)
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
        lighting = self._lighting_of(part, irradiance)
        # A pass takes what its slots name.
        drawn = {name: values[name] for name in lighting.names if name in values}
        lighting.draw_rows(commands, targets, what.hits.rows, **drawn)

    def _bound(
        self, commands: Commands, what: HitsInLight, irradiance: Irradiance
    ) -> dict[str, Any]:
        """The resources of lighting, by slot name."""
        kit, lights, hits = self.kit, self.kit.lights, what.hits
        # Emissive surfaces that rays hit count as a sample of their light, not by their material.
        eye = (0.0, 0.0, 0.0)
        emission = hits.emission
        if self._area is not None:
            emission = self._area.encode(commands, hits, (np.eye(4), eye), lights.table)
        # Hits have positions of their own: no camera takes part.
        params = LightingParams(
            world_from_clip=np.eye(4),
            eye=eye,
            light_count=kit.emitters.plain,
            size=hits.size,
            environment_rotation=lights.background.rotation,
            has_lattice=1,
            ray_start=self.shadows.raised if self.shadows else 0.0,
            # The suns that rays would meet are lights already.
            **{**lights.background.seen, **NO_SUNS},
        )
        return {
            "params": params,
            **irradiance.bound,
            **lights.bound,
            **(self.attenuation.bound if self.attenuation else {}),
            **hits.bound,
            "emission": emission,
            "near_field": self._no_near_field,
            "sky_cube": what.sky.cube,
            **kit.blockers.surface_bound,
            "linear_clamp": self._linear,
            **(self.shadows.bound if self.shadows else {}),
        }

    def _lighting_of(self, part: Part, irradiance: Irradiance) -> Lighting:
        # What another part has lit has its shadows.
        shadows = None if part == "rest" else self.shadows
        # A pass for each combination that a frame asks for, made when it first does.
        key = (part, shadow_key(shadows))
        if key not in self._passes:
            count, directional = self.kit.emitters.plain, self.kit.lights.parallel.layers
            emitters = Emitters(
                has_directional=directional > 0,
                has_local=count > directional,
                is_one_directional=count == directional == 1,
                has_panes=self.kit.meshes.has_translucent,
                shadows=shadows,
            )
            light = LatticeLight(
                has_sky=self.kit.sky.maps.layers > 0,
                is_one_lattice=self.kit.lattices.table.count == 1,
            )
            light = replace(light, damping=irradiance.damping)
            self._passes[key] = Lighting(
                self.gpu,
                part,
                emitters,
                light,
                attenuation=self.attenuation,
                points=HITS,
            )
        return self._passes[key]
