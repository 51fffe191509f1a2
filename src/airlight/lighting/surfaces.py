"""The image of surfaces: G-buffer, screen-space near field, and lighting.

Lights and emission are drawn first; horizon angles then search that image for near occluders; the
light of lattices is added last, the occluders' radiance replacing what they hide of it. Fields
arrive solved: this module knows no solver.
"""

from __future__ import annotations

import numpy as np

from ..area.coverage import Coverage
from ..area.lighting import AreaLighting
from ..gpu.commands import Commands
from ..gpu.memory import Texture
from ..lattice.irradiance import Irradiance, SkyIrradiance
from ..scene.scene import Scene
from ..surface.hits import PIXELS
from .gathered import Gathered
from .glossy import is_any_glossy
from .glossy_pixels import GlossyPixels, can_list
from .kit import Kit
from .lighting import LightingPasses
from .occlusion import Occlusion, lattice_reach
from .shadow_rays import ShadowRays
from .slots import AFTER, Attenuation, Gloss, Part
from .view import View


class Surfaces:
    """Draws a view's surfaces. `attenuation`: the media between lights and surfaces."""

    def __init__(self, kit: Kit, scene: Scene, attenuation: Attenuation | None = None) -> None:
        self.kit, self.gpu = kit, kit.gpu
        self._passes = LightingPasses(kit, attenuation, PIXELS)
        self._cpu_scope = kit.gpu.scope()  # of passes of CPU adapters, by the image's size
        self.glossy: GlossyPixels | None = None
        self._occlusion: Occlusion | None = None
        # Mirrored rays are followed where any material is smooth enough.
        self._is_glossy = kit.settings.glossy_rays and is_any_glossy(
            mesh.material for mesh in scene.meshes
        )
        # Devices bind so many textures at once, and every volume brings its own.
        self._is_one = {traced: self._passes.is_one(is_traced=traced) for traced in (False, True)}
        # Lights with extent: their light on surfaces, and their part of each pixel.
        self._area: AreaLighting | None = None
        self._coverage: Coverage | None = None
        if kit.area_shadows is not None:
            materials = (mesh.material for mesh in scene.meshes)
            self._area = AreaLighting(kit.gpu, kit.area_shadows, materials, attenuation)
            # Media between the eye and what glows take by the depth of what each sample hits.
            if kit.context.scene.medium is None and not kit.context.scene.volumes:
                self._coverage = Coverage(kit.gpu, kit.emitters.count)
        self._emission: Texture | None = None
        self._shadows: ShadowRays | None = None

    def draw(
        self,
        commands: Commands,
        view: View,
        irradiance: Irradiance,
        sky: SkyIrradiance,
        gathered: Gathered | None = None,
    ) -> None:
        """Fill the view's G-buffer and its layers of direct and indirect light.

        Light that rays `gathered` replaces that of lattices and sky, and the near field with it.
        """
        meshes = self.kit.meshes
        with commands.stage("g-buffer"):
            view.gbuffer.encode(commands, meshes, view.clip_from_world)
        has_mirrors = gathered is not None and gathered.mirrored is not None
        self._emission = self._emitted(commands, view, has_mirrors=has_mirrors)
        # Rays look for shadows in stills, and where rays gather light anyway.
        is_traced = view.is_still or gathered is not None
        self._shadows = self.kit.shadow_rays(commands) if is_traced else None
        # Gathered light replaces all that follows from lattices.
        if gathered is not None:
            with commands.stage("lighting"):
                self._light(commands, view, "lights", irradiance, sky, gathered)
                self._light(commands, view, "gathered", irradiance, sky, gathered)
            return
        is_occluded = self.kit.settings.ambient_occlusion and bool(meshes.draws)
        has_near_field = is_occluded and self._has_near_field(irradiance)
        # The near field sends the radiance that lights and emission give it.
        if has_near_field:
            with commands.stage("lighting"):
                self._light(commands, view, "lights", irradiance, sky)
        if is_occluded:
            with commands.stage("ambient occlusion"):
                self._occlude(commands, view, has_light=has_near_field)
        # The lattices' light, with that of lights where it was not drawn yet; two passes where one
        # would bind more than the device may.
        with commands.stage("lighting"):
            part: Part = "lattices" if has_near_field else "whole"
            if part == "whole" and not self._is_one[self._shadows is not None]:
                self._light(commands, view, "lights", irradiance, sky)
                part = "rest"
            self._light(commands, view, part, irradiance, sky)

    def _emitted(self, commands: Commands, view: View, *, has_mirrors: bool) -> Texture:
        """Draw emission, and the light of emitters."""
        # Without lights with extent, emission is that of the G-buffer.
        if self._area is None:
            return view.gbuffer.emission
        with commands.stage("area lights"):
            self._area.shadows.encode(commands, self.kit.meshes, view.sample, *self.kit.box)
            camera = (view.world_from_clip, view.eye)
            table = self.kit.lights.table
            emission, is_still = self._covered(commands, view), view.is_still
            return self._area.encode(
                commands,
                view.gbuffer,
                camera,
                table,
                emission=emission,
                is_still=is_still,
                has_mirrors=has_mirrors,
            )

    def _covered(self, commands: Commands, view: View) -> Texture:
        """The glow of surfaces: in stills polygons by their part of each pixel, unless blurred."""
        # Single frames, and images that a lens blurs, show polygons as they are rasterised.
        if self._coverage is None or not view.is_still or view.camera.aperture_m > 0.0:
            return view.gbuffer.emission
        camera = (view.clip_from_world, view.world_from_clip, np.array(view.eye))
        emitters = self.kit.emitters.list
        return self._coverage.encode(commands, view.gbuffer, emitters, camera, view.jitter_px)

    def _has_near_field(self, irradiance: Irradiance) -> bool:
        """Whether near surfaces light each other: where there is indirect light at all."""
        return irradiance.is_reflected and bool(self.kit.context.scene.lights)

    def _occlude(self, commands: Commands, view: View, *, has_light: bool) -> None:
        # Surfaces that are smaller than the lattices' cells occlude in screen space.
        wanted = self.kit.settings.occlusion_radius
        if self._occlusion is None:
            self._occlusion = Occlusion(self.gpu, has_light=has_light)
        self._occlusion.encode(
            commands,
            view.gbuffer,
            view.occlusion,
            view.world_from_clip,
            lattice_reach(wanted, self.kit.lattices.placements),
            lit=view.layers.lit if has_light else None,
        )

    def _light(
        self,
        commands: Commands,
        view: View,
        part: Part,
        irradiance: Irradiance,
        sky: SkyIrradiance,
        gathered: Gathered | None = None,
    ) -> None:
        layers = view.layers
        # What all parts read, then what this one has besides.
        values = self._passes.bound(
            irradiance,
            sky,
            self._shadows,
            world_from_clip=view.world_from_clip,
            eye=view.eye,
            size=view.size,
            ray_start=0.0,  # by the distance to the eye
        )
        values |= view.gbuffer.bound
        values |= {"emission": self._emission, "near_field": view.occlusion.near}
        values |= {"lit": layers.lit} if part in AFTER else {}
        values |= gathered.bound if gathered else {}
        # Mirrored light is added to glossy pixels alone.
        self._make_cpu_passes(view.size)
        gloss = self._gloss_of(part, gathered)
        listed = self.glossy if gloss == "listed" else None
        values |= listed.empty(commands, view.size) if listed else {}
        targets = (layers.lit,) if part == "lights" else layers.targets
        self._passes.of(part, irradiance, self._shadows, gloss).light(commands, targets, values)
        if listed:
            listed.encode(commands, layers.targets, values)

    def _make_cpu_passes(self, size: tuple[int, int]) -> None:
        """Create the extra pass of CPU adapters: glossy pixels."""
        # Glossy pixels are listed where that is this device's path and the list fits.
        is_listed = self._is_glossy and self.gpu.paths.listed_gloss and can_list(self.gpu, size)
        if is_listed == (self.glossy is not None):
            return
        self._cpu_scope.release()
        self.glossy = GlossyPixels(self._cpu_scope, self._passes.lattices) if is_listed else None

    def _gloss_of(self, part: Part, gathered: Gathered | None) -> Gloss:
        # A gather follows mirrored rays itself; else a list has them, or the pass follows them.
        if gathered is not None:
            return "traced" if part == "gathered" and gathered.mirrored else "none"
        if self.glossy is not None and part != "lights":
            return "listed"
        return "inline" if self._is_glossy else "none"
