"""The final gather as a solver: irradiance of a view's pixels, from rays and the lattices' cache.

points -> rays -> what they meet, lit as pixels are; rays from there, and so on -> sums -> shared
between neighbours -> pixels
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ..fields import Fields, Frame, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Texture
from ..lighting.gathered import Gathered
from ..lighting.glossy import is_any_glossy
from ..lighting.hits import HitLighting
from ..lighting.kit import Kit
from ..lighting.occlusion import Occlusion, lattice_reach
from ..lighting.view import View
from ..media.gpu_media import GpuMedia
from .air import Air
from .albedo import Albedos
from .batches import CellBatches, ViewBatches
from .beams import Beams
from .history import lit_alike
from .mirrors import Mirrors
from .segments import PathSegments
from .settings import GatherSettings
from .sky import SkyRays
from .sky_cells import SkyCells
from .trace import Trace

JITTERS, LEAST_IMAGES = 2, 8
"""Images of a sample of a still, which share its gathered light, and the least of a whole still:
most of what one of few samples is off is edges (docs/decisions.md)."""


class GatherSolver(Solver):
    """Yields `gathered` for views; lattices' irradiance is what it takes for later bounces."""

    def __init__(
        self,
        kit: Kit,
        settings: GatherSettings,
        media: GpuMedia | None = None,
        *,
        sources: int = 0,
        bounces: bool = True,
    ) -> None:
        """`media`: those in the way of rays; `sources`: the most textures of what they scatter.

        `bounces`: whether the lattices' light is on what rays meet, so that it bounces more than
        once.
        """
        self.kit, self.settings = kit, settings
        # What lights hits, and media along rays.
        self._lighting = HitLighting(kit, media)
        self._air = Air(kit.gpu, media, sources=sources) if media else None
        self._beams = Beams(kit.gpu, kit) if media else None
        # Buffers are made once the sizes of images and lattices are known.
        self._sized: ViewBatches | None = None
        self._in_air: CellBatches | None = None
        self._scope, self._air_scope = kit.gpu.scope(), kit.gpu.scope()
        # What lies outside, and the paths that may find it.
        self._cells = SkyCells(kit.gpu)
        self._paths = PathSegments(
            kit, settings, self._cells, self._lighting, self._air, bounces=bounces
        )
        # Points are shaded by near occluders, as pixels are.
        is_occluded = kit.settings.ambient_occlusion
        self._occlusion = Occlusion(kit.gpu) if is_occluded else None
        self._albedos: Albedos | None = None
        self._scene, self._is_changing = kit.context.scene, False
        self._is_relit = False
        # What the first image of a sample found: sums of points, and light in media.
        self._found: tuple[Texture, dict[str, Any]] | None = None
        # What smooth surfaces mirror is lit apart: images of another size.
        self._mirrors: Mirrors | None = None
        materials = (mesh.material for mesh in self._scene.meshes)
        if kit.settings.glossy_rays and is_any_glossy(materials):
            segments = settings.gather_bounces
            self._mirrors = Mirrors(kit, HitLighting(kit, media), self._air, segments)

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Nothing that does not depend on a view."""
        # Frames go on from those before as long as light stays the same.
        is_other = not lit_alike(frame.scene, self._scene)
        self._is_changing |= is_other
        self._is_relit |= is_other
        self._scene = frame.scene
        self._cells.take(frame.scene.environment)
        return fields

    def solve_view(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """`fields` with the irradiance of the view's pixels, where this frame gathers."""
        if not self._gathers(view):
            return fields
        self._make(commands)
        sized = self._fitted(view.size)
        # Images of a sample differ by less than a pixel: all but the first take what that found.
        if view.jitter == 0 or self._found is None:
            self._found = self._gathered(commands, view, sized, fields)
        else:
            self._draw_surfaces(commands, view)
        sums, in_air = self._found
        fields = replace(fields, **in_air)
        with commands.stage("gather upsampling"):
            irradiance = fields.irradiance or self.kit.no_irradiance
            gathered = sized.upsampling.encode(commands, view, sums, irradiance, fields.sky)
        return replace(fields, gathered=self._with_mirrors(commands, view, fields, gathered))

    def _draw_surfaces(self, commands: Commands, view: View) -> None:
        """The view's G-buffer, and what near surfaces hide of its pixels."""
        with commands.stage("g-buffer"):
            view.gbuffer.encode(commands, self.kit.meshes, view.clip_from_world)
        if self._occlusion is not None:
            with commands.stage("gather points"):
                settings, placements = self.kit.settings, self.kit.lattices.placements
                reach = lattice_reach(settings.occlusion_radius, placements)
                self._occlusion.encode(
                    commands, view.gbuffer, view.occlusion, view.world_from_clip, reach
                )

    def _gathered(
        self, commands: Commands, view: View, sized: ViewBatches, fields: Fields
    ) -> tuple[Texture, dict[str, Any]]:
        """The sums of the view's points, shared; and the fields of light in media, by name."""
        kit = self.kit
        # A moving frame may go on from the light of those before it: its rays go on from theirs.
        history = None if view.is_still or view.sample else sized.history
        number = history.number if history else view.sample
        # Area lights shine on what rays of pixels meet, and on what those of cells do.
        if kit.area_shadows is not None:
            with commands.stage("area lights"):
                kit.area_shadows.encode(commands, kit.meshes, view.sample, *kit.box)
        # What the rays start from, and what lights the surfaces that they meet.
        self._draw_surfaces(commands, view)
        with commands.stage("gather points"):
            sized.points.encode(commands, view)
        # Lit patches and the light in the air are found before the paths that ask for them.
        guided = self._paths.guided(commands, sized, fields)
        fields = self._gathered_air(commands, view, fields)
        self._gather(commands, view, sized, number, fields, guided)
        # Towards the sky go rays of their own, chosen by its cells.
        rays = self.settings.gather_rays
        with commands.stage("gather sky"):
            self._sky_rays.encode(commands, sized.points, sized.sums, rays, number)
            sums = sized.found.encode(commands, view, sized.sums.buffer)
        # A moving frame adds the frames before it; a still has samples of its own.
        if history:
            with commands.stage("gather history"):
                sums = history.encode(commands, view, sums, is_changing=self._is_changing)
            self._is_changing = False
        with commands.stage("gather filter"):
            sums = sized.filtering.encode(commands, view, sums, self._cells.count(rays))
        # What no ray meets is not noisy: its edges need no filter.
        if self._beams is not None and fields.forward:
            with commands.stage("gather lighting"):
                pair = sums, sized.filtering.spare
                sums = self._beams.encode(commands, sized.points, pair, rays, fields.forward)
        return sums, {"scattered": fields.scattered, "air": fields.air}

    def _gather(
        self,
        commands: Commands,
        view: View,
        sized: ViewBatches,
        number: int,
        fields: Fields,
        guided: int,
    ) -> None:
        """Trace and light the paths of a sample of the image, batch by batch, and add them up."""
        # Batches of paths: traced, lit segment by segment, added up.
        rays = self.settings.gather_rays
        sample = range(number * rays, (number + 1) * rays)
        # What cells know of later segments' light is of this image, as long as that stays the same.
        if view.sample == 0 or self._is_relit:
            sized.later.begin(commands)
            self._is_relit = False
        for first in range(sample.start, sample.stop, sized.batch):
            numbers = range(first, min(first + sized.batch, sample.stop))
            later, passed = None, sized.later.passed
            for segment in self._paths.followed(commands, sized, numbers, fields, guided):
                if segment.index == 0:
                    with commands.stage("gather lighting"):
                        sized.sums.encode(commands, view, sized.paths, passed, numbers, sample)
                    later = 0
                elif segment.index == 1:
                    later = len(segment.numbers)
            # What later segments found counts once per batch, of the rays that have them.
            if later is not None and self._paths.is_any_later:
                with commands.stage("gather later light"):
                    hits = sized.ends.of(0).hits
                    sized.later.encode(
                        commands, view, sized.paths, hits, numbers, later, sized.sums
                    )
        # Rays towards lit patches share with the others what both may find.
        if guided:
            self._paths.add_guided(commands, sized, number, fields)

    def _with_mirrors(
        self, commands: Commands, view: View, fields: Fields, gathered: Gathered
    ) -> Gathered:
        """With what smooth surfaces mirror, where there are any."""
        if self._mirrors is None or self._albedos is None:
            return gathered
        rays = self.kit.rays.of_frame(commands)
        found = self._mirrors.encode(commands, view, fields, rays, self._albedos)
        return replace(gathered, mirrored=found)

    def _gathered_air(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """`fields` with the light in media of lattices found by rays of their cells."""
        rays, source = self.settings.gather_air, fields.scattered
        # In lattices of media that are marched, if their cells send rays.
        if not rays or self._air is None or source is None or fields.air is None:
            return fields
        # Buffers are for so many cells: only lattices of other sizes need new ones.
        cells = sum(placement.cells for placement in source.levels)
        if self._in_air is None or self._in_air.cells != cells:
            self._air_scope.release()
            self._in_air = CellBatches(
                self._air_scope, self.kit, cells, rays, self._cells, self._air.media
            )
        sized = self._in_air
        seen = sized.look(view, source.levels)
        with commands.stage("gather points"):
            walls = self.kit.blockers.bound["lattice_walls"]
            sized.points.encode(commands, view, source.levels, seen, walls)
        # Rays of later samples meet what those of earlier ones found.
        given, number = fields.air, sized.number_of(view.sample, fields.air)
        met = fields if number == 0 else replace(fields, air=sized.found)
        numbers = range(view.sample * sized.rays, (view.sample + 1) * sized.rays)
        for _ in self._paths.followed(commands, sized, numbers, met):
            pass
        with commands.stage("gather lighting"):
            paths, patches = sized.paths.buffer, self._paths.patches
            scattered, sized.found = sized.sums.encode(
                commands, sized.points, paths, numbers, (source, given), number, patches
            )
        return replace(fields, scattered=scattered, air=sized.found)

    def _gathers(self, view: View) -> bool:
        """Whether this view does. Lights by the thousand are in lattices alone, and seen there."""
        # Stills gather, moving frames on request.
        is_wanted = view.is_still or self.settings.gather == "always"
        can_gather = view.may_gather and not self._scene.light_groups
        return is_wanted and can_gather and bool(self.kit.meshes.draws)

    def _make(self, commands: Commands) -> None:
        """Bring the hierarchy up to date, and the passes that look into it."""
        kit = self.kit
        # Maps of materials stay; meshes of one material share them.
        if self._albedos is None:
            materials = {id(m.material): m.material for m in kit.meshes.original}
            self._albedos = Albedos(kit.gpu, list(materials.values()))
        rays = kit.rays.of_frame(commands)
        # Once something has moved, rays also meet instances.
        if self._paths.trace is None or self._paths.trace.constants != rays.constants:
            self._paths.trace = Trace(kit.gpu, rays, self._albedos)
            media = self._air.media if self._air else None
            self._sky_rays = SkyRays(kit.gpu, rays, self._cells, media)
        # Shadow rays of hits look into the same hierarchy.
        self._lighting.shadows = kit.shadow_rays(commands)
        if self._mirrors is not None:
            self._mirrors.lighting.shadows = self._lighting.shadows

    def _fitted(self, size: tuple[int, int]) -> ViewBatches:
        if self._sized is None or self._sized.points.size != size:
            # The old buffers go first: both sets may not fit.
            self._scope.release()
            self._sized = self._found = None
            has_air = self._air is not None
            self._sized = ViewBatches(
                self._scope, self.kit, size, self.settings, self._cells, has_air=has_air
            )
        return self._sized

    def jitters(self, samples: int) -> int:
        """Several where scenes have surfaces that gather, more where samples are few."""
        if not self.kit.meshes.draws or self._scene.light_groups:
            return 1
        return max(JITTERS, math.ceil(LEAST_IMAGES / samples))

    @property
    def stats(self) -> dict[str, Any]:
        """The rays of a point, for --stats."""
        return {"gather_rays": self.settings.gather_rays}
