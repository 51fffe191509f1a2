"""The pass that lights surfaces: lights with shadows, emission, sky, lattices, background.

The material is Lambert plus GGX (Walter2007) with Smith's height-correlated shadowing (Heitz2014)
and Schlick's Fresnel term, as glTF 2.0 defines it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

from ..gpu.commands import Commands
from ..gpu.counted import CountedRows
from ..gpu.demands import fits
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.memory import Texture, linear_sampler
from ..lattice.irradiance import Irradiance, SkyIrradiance
from ..surface.hits import PIXELS, Points
from .kernel import Kernel, LatticeLight, LightKinds, lattices_kernel, lights_kernel
from .kit import Kit
from .shadow_rays import ShadowRays, shadow_key
from .slots import AFTER, Attenuation, Gloss, LightingParams, Part, lighting_slots


class Lighting(FullscreenPass):
    """G-buffer -> direct and indirect radiance, W m^-2 sr^-1."""

    targets = ("rgba32float", "rgba32float")

    def __init__(
        self,
        gpu: Gpu,
        part: Part,
        kinds: LightKinds,
        lattices: LatticeLight,
        *,
        gloss: Gloss = "none",
        attenuation: Attenuation | None = None,
        points: Points = PIXELS,
    ) -> None:
        """`part`: which light is added up. `attenuation`: the media between lights and surfaces.

        `points`: whether surfaces are those of pixels, or hits of rays.
        """
        # Rays look for shadows where the device binds so much.
        slots_of = partial(
            lighting_slots, part, attenuation, gloss, points, has_panes=kinds.has_panes
        )
        shadows, self.slots = kinds.shadows, slots_of(is_traced=kinds.shadows is not None)
        if shadows is not None and not fits(gpu, self.slots):
            shadows, self.slots = None, slots_of()
        traced = shadows.constants(points) if shadows else None
        # What is added up: lattices' light, lights', or both.
        kernel = (
            Kernel(points.wgsl, {"HAS_SURFACES": float(kinds.has_surfaces)}, {})
            + lattices_kernel(part, lattices, gloss)
            + lights_kernel(part, kinds, attenuation, traced)
        )
        super().__init__(
            gpu,
            generated=kernel.generated,
            constants=kernel.constants,
            firsts=kernel.firsts,
            targets=self.targets[:1] if part == "lights" else None,
        )

    def light(
        self,
        commands: Commands,
        targets: tuple[Texture, ...],
        values: Mapping[str, Any],
        rows: CountedRows | None = None,
    ) -> None:
        """Write `targets`, all or `rows` of them; of the `values` it takes what its slots name."""
        drawn = {slot.name: values[slot.name] for slot in self.slots}
        self.draw_rows(commands, targets, rows, **drawn)


class LightingPasses:
    """The passes that light pixels, or hits, each made when a frame first asks for it.

    `attenuation`: the media between lights and surfaces. `points`: what surfaces are.
    """

    def __init__(self, kit: Kit, attenuation: Attenuation | None, points: Points) -> None:
        self.kit, self.attenuation, self._points = kit, attenuation, points
        self._made: dict[tuple[Any, ...], Lighting] = {}
        self._linear = linear_sampler(kit.gpu)
        # What lights without extent there are; what is near a pixel is not near a hit.
        count, directional = kit.emitters.plain, kit.lights.parallel.layers
        self._kinds = LightKinds(
            has_surfaces=bool(kit.meshes.draws),
            has_directional=directional > 0,
            has_local=count > directional,
            is_one_directional=count == directional == 1,
            has_panes=kit.meshes.has_translucent,
        )
        self.lattices = LatticeLight(
            is_occluded=kit.settings.ambient_occlusion and points is PIXELS,
            has_sky=kit.sky.maps.layers > 0,
            is_one_lattice=kit.lattices.table.count == 1,
        )

    def is_one(self, *, is_traced: bool = False) -> bool:
        """Whether the device binds all that a single pass reads, where `is_traced` rays, too."""
        slots = lighting_slots(
            "whole",
            self.attenuation,
            points=self._points,
            has_panes=self._kinds.has_panes,
            is_traced=is_traced,
        )
        return fits(self.kit.gpu, slots)

    def of(
        self,
        part: Part,
        irradiance: Irradiance,
        shadows: ShadowRays | None,
        gloss: Gloss = "none",
    ) -> Lighting:
        """The pass for a part of the light; `shadows`: rays where shadow maps are unsure."""
        # What another part has lit has its shadows.
        shadows = None if part in AFTER else shadows
        key = (part, gloss, shadow_key(shadows))
        if key not in self._made:
            lattices = replace(
                self.lattices,
                damping=irradiance.damping,
                has_interreflection=irradiance.has_interreflection,
            )
            self._made[key] = Lighting(
                self.kit.gpu,
                part,
                replace(self._kinds, shadows=shadows),
                lattices,
                gloss=gloss,
                attenuation=self.attenuation,
                points=self._points,
            )
        return self._made[key]

    def bound(
        self, irradiance: Irradiance, sky: SkyIrradiance, shadows: ShadowRays | None, **seen: Any
    ) -> dict[str, Any]:
        """What passes read but for surfaces, by slot name.

        `seen`: the values of `LightingParams` that neither lights nor their background give.
        """
        kit, background = self.kit, self.kit.lights.background
        values = {
            "light_count": kit.emitters.plain,
            "has_lattice": 1,
            "environment_rotation": background.rotation,
            **background.seen,
            **seen,
        }
        return {
            "params": LightingParams(**values),
            **irradiance.bound,
            **kit.lights.bound,
            **(self.attenuation.bound if self.attenuation else {}),
            "sky_cube": sky.cube,
            **kit.blockers.surface_bound,
            "linear_clamp": self._linear,
            **(shadows.bound if shadows else {}),
        }


class RadianceLayers:
    """The targets of lighting: direct (with emission, sky, background; a = 1), indirect.

    `lit` is the direct layer without the sky, which exists where near surfaces light each other;
    `also` the light of a second field, which exists where hits have one.
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        # Layers that few images ask for are made for the first that does.
        self._gpu, self._size = gpu, size
        self.direct, self.indirect = self._another("direct"), self._another("indirect")

    @property
    def targets(self) -> tuple[Texture, Texture]:
        """In the order of the pass's targets."""
        return (self.direct, self.indirect)

    @cached_property
    def lit(self) -> Texture:
        """Radiance of surfaces by lights and emission, and the background."""
        return self._another("lit")

    @cached_property
    def also(self) -> Texture:
        """Radiance of surfaces by a second field."""
        return self._another("light of another field")

    def _another(self, name: str) -> Texture:
        return Texture(self._gpu, name, self._size, "rgba32float", target=True, written=True)
