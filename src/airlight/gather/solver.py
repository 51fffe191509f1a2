"""The final gather as a solver: irradiance of a view's pixels, from rays and the lattices' cache.

points -> rays -> what they meet, lit as pixels are; rays from there, and so on -> sums -> shared
between neighbours -> pixels
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ..fields import Fields, Frame, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Buffer, Texture
from ..lighting.gathered import Gathered
from ..lighting.glossy import is_any_glossy
from ..lighting.hits import HitLighting
from ..lighting.kit import Kit
from ..lighting.lighting import RadianceLayers
from ..lighting.occlusion import Occlusion, lattice_reach
from ..lighting.view import View
from ..media.gpu_media import GpuMedia
from ..surface.hits import Hits
from .air import Air, light_in
from .albedo import Albedos
from .batches import CellBatches, ViewBatches
from .beams import Beams
from .guide import LightGuide
from .guided import GuidedRays
from .history import lit_alike
from .mirrors import Mirrors
from .paths import Lattices, SegmentLight
from .settings import GatherSettings
from .sky import SkyRays
from .sky_cells import SkyCells
from .trace import Segment, Trace


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
        self.kit, self.settings, self._bounces = kit, settings, bounces
        self._lighting = HitLighting(kit, media)
        self._air = Air(kit.gpu, media, sources=sources) if media else None
        self._beams = Beams(kit.gpu, kit) if media else None
        self._sized: ViewBatches | None = None
        self._in_air: CellBatches | None = None
        self._scope, self._air_scope = kit.gpu.scope(), kit.gpu.scope()
        self._cells = SkyCells(kit.gpu)
        self._guide = LightGuide(kit.gpu)
        is_occluded = kit.settings.ambient_occlusion
        self._occlusion = Occlusion(kit.gpu) if is_occluded else None
        self._trace: Trace | None = None
        self._albedos: Albedos | None = None
        self._scene, self._is_changing = kit.context.scene, False
        # What smooth surfaces mirror is lit apart: images of another size.
        self._mirrors: Mirrors | None = None
        materials = (mesh.material for mesh in self._scene.meshes)
        if kit.settings.glossy_rays and is_any_glossy(materials):
            segments = settings.gather_bounces
            self._mirrors = Mirrors(kit, HitLighting(kit, media), self._air, segments)

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Nothing that does not depend on a view."""
        self._is_changing |= not lit_alike(frame.scene, self._scene)
        self._scene = frame.scene
        self._cells.take(frame.scene.environment)
        return fields

    def solve_view(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """`fields` with the irradiance of the view's pixels, where this frame gathers."""
        kit = self.kit
        if not self._gathers(view):
            return fields
        self._make(commands)
        sized = self._fitted(view.size)
        # A moving frame may go on from the light of those before it: its rays go on from theirs.
        history = None if view.is_still or view.sample else sized.history
        number = history.number if history else view.sample
        # Area lights shine on what rays of pixels meet, and on what those of cells do.
        if kit.area_shadows is not None:
            with commands.stage("area lights"):
                kit.area_shadows.encode(commands, kit.meshes, view.sample, *kit.box)
        # What the rays start from, and what lights the surfaces that they meet.
        with commands.stage("g-buffer"):
            view.gbuffer.encode(commands, kit.meshes, view.clip_from_world)
        with commands.stage("gather points"):
            if self._occlusion is not None:
                reach = lattice_reach(kit.settings.occlusion_radius, kit.lattices.placements)
                self._occlusion.encode(
                    commands, view.gbuffer, view.occlusion, view.world_from_clip, reach
                )
            sized.points.encode(commands, view)
        guided = self._guided(commands, sized, fields)
        fields = self._gathered_air(commands, view, fields)
        # Batches of paths: traced, lit segment by segment, added up.
        rays = self.settings.gather_rays
        sample = range(number * rays, (number + 1) * rays)
        for first in range(sample.start, sample.stop, sized.batch):
            numbers = range(first, min(first + sized.batch, sample.stop))
            for index in self._followed(commands, sized, numbers, fields, guided):
                if index == 0:
                    with commands.stage("gather lighting"):
                        sized.sums.encode(commands, view, sized.paths, numbers, sample)
            with commands.stage("gather lighting"):
                sized.sums.encode_later(commands, view, sized.paths, numbers)
        if guided:
            self._add_guided(commands, sized, sized.guided, number, fields)
        with commands.stage("gather sky"):
            self._sky_rays.encode(commands, sized.points, sized.sums, rays, number)
        sums = sized.sums.buffer
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
                self._beams.encode(commands, sized.points, sums, rays, fields.forward)
        with commands.stage("gather upsampling"):
            irradiance = fields.irradiance or kit.no_irradiance
            gathered = sized.upsampling.encode(commands, view, sums, irradiance, fields.sky)
        return replace(fields, gathered=self._with_mirrors(commands, view, fields, gathered))

    def _guided(self, commands: Commands, sized: ViewBatches, fields: Fields) -> int:
        """Find what lights shine on that points see; how many rays of each point go there."""
        if not sized.guided.count:
            return 0
        diagonal = float(np.linalg.norm(self.kit.box[1] - self.kit.box[0]))
        rays = self.kit.rays.of_frame(commands)
        with commands.stage("gather guide"):
            is_any = self._guide.encode(commands, fields.lit, sized.points, rays, diagonal)
        return sized.guided.count if is_any else 0

    def _add_guided(
        self,
        commands: Commands,
        sized: ViewBatches,
        guided: GuidedRays,
        number: int,
        fields: Fields,
    ) -> None:
        """Trace rays towards what lights shine on, light what they meet and add that up."""
        assert self._trace is not None
        numbers = range(number * guided.count, (number + 1) * guided.count)
        segment = Segment(numbers, 0, self.kit.rays.raised)
        patches, hits = self._guide.patches, guided.hits
        with commands.stage("gather rays"):
            self._trace.encode_guided(commands, sized.points, hits, segment, patches)
        if self._air is not None and guided.air is not None:
            self._pass_air(
                commands, sized, (sized.points.places, hits), segment, fields, guided.air
            )
        # The same light as that of which rays by the cosine leave a part.
        count = self.settings.gather_bounces if self._bounces else 1
        with commands.stage("gather lighting"):
            told = self._told(count - 1, count)
            light = self._light(commands, guided.layers, hits, fields, told, is_last=count == 1)
            guided.encode(commands, light.lights, patches, sized.sums.buffer)

    def _pass_air(
        self,
        commands: Commands,
        sized: ViewBatches | CellBatches,
        way: tuple[Texture, Hits],
        segment: Segment,
        fields: Fields,
        air: Buffer,
    ) -> None:
        """What media along a segment scatter into it, and how much light they let by."""
        assert self._air is not None
        with commands.stage("gather air"):
            self._air.encode(commands, sized.points.reduced, way, segment, light_in(fields), air)

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
        with commands.stage("gather points"):
            walls = self.kit.blockers.bound["lattice_walls"]
            sized.points.encode(commands, view, source.levels, walls)
        # Rays of later samples meet what those of earlier ones found.
        given, number = fields.air, sized.number_of(view.sample, fields.air)
        met = fields if number == 0 else replace(fields, air=sized.found)
        numbers = range(view.sample * sized.rays, (view.sample + 1) * sized.rays)
        for _ in self._followed(commands, sized, numbers, met):
            pass
        with commands.stage("gather lighting"):
            scattered, sized.found = sized.sums.encode(
                commands, sized.paths.buffer, numbers, (source, given), number
            )
        return replace(fields, scattered=scattered, air=sized.found)

    def _followed(
        self,
        commands: Commands,
        sized: ViewBatches | CellBatches,
        numbers: range,
        fields: Fields,
        guided: int = 0,
    ) -> Iterator[int]:
        """Trace paths of several segments; lattices light what the last of them meets.

        `guided`: rays of each point beside these that are led to what lights shine on.

        Yields the number of each segment once its light is in the paths; none where nobody waits.
        """
        assert self._trace is not None
        rays = sized.rays
        count = self.settings.gather_bounces if self._bounces else 1
        hits, before = sized.hits
        for index in range(count):
            if not commands.is_wanted:
                return
            # What each ray meets, from the surface that the one before it met.
            segment = Segment(numbers, index, self.kit.rays.raised)
            with commands.stage("gather rays"):
                guide = self._guide.patches, sized.paths.buffer
                self._trace.encode(commands, sized.points, (before, hits), segment, guide)
            # What media along the segment scatter into it, and how much light they let by.
            if self._air is not None and sized.paths.air is not None:
                way = (sized.points.places if index == 0 else before.positions, hits)
                self._pass_air(commands, sized, way, segment, fields, sized.paths.air)
            with commands.stage("gather lighting"):
                told = self._told(count - 1 - index, count)
                light = self._light(
                    commands, sized.layers, hits, fields, told, is_last=index + 1 == count
                )
                patches = self._guide.patches, guided
                sized.paths.encode(commands, hits, light, segment, rays, told, patches)
            yield index
            # The next segment starts where this one ended.
            hits, before = before, hits

    def _told(self, left: int, count: int) -> Lattices:
        """What becomes of the lattices' light with so many segments `left` of `count`."""
        if not self._bounces or left > 1:
            return Lattices.UNASKED
        if count == 1:
            return Lattices.ADDED
        return Lattices.TOLD if left else Lattices.LEFT

    def _light(
        self,
        commands: Commands,
        layers: RadianceLayers,
        hits: Hits,
        fields: Fields,
        told: Lattices,
        *,
        is_last: bool,
    ) -> SegmentLight:
        """The textures with the light of `hits`.

        Of lattices all that they know, where they are asked; always that of lights that media only
        scatter forwards, which no ray meets. What a later segment finds of a mild sky, no lattice
        has to say.
        """
        forward = fields.forward
        cache = fields.irradiance or self.kit.no_irradiance
        is_asked, has_sky = told is not Lattices.UNASKED, is_last or not self._cells.is_mild
        light = self._lighting
        if not (is_asked or has_sky or forward):
            return SegmentLight(light.lights(commands, hits, layers, cache, fields.sky))
        # One field, or lattices' and forward light apart, the second beside the first.
        first = cache if is_asked else forward or self.kit.darkened(cache)
        if has_sky and not (is_asked and forward):
            light.encode(commands, hits, layers, first, fields.sky)
            lit, found = layers.direct, layers.indirect
        else:
            lit, found = light.apart(commands, hits, layers, first, fields.sky)
            lit = layers.direct if has_sky else lit
        if not is_asked:
            return SegmentLight(lit, forward=found if forward else None)
        if forward is None:
            return SegmentLight(lit, lattices=found)
        along = light.also(commands, hits, layers, forward, fields.sky)
        return SegmentLight(lit, along, found)

    def _gathers(self, view: View) -> bool:
        """Whether this view does. Lights by the thousand are in lattices alone, and seen there."""
        is_wanted = view.is_still or self.settings.gather == "always"
        can_gather = view.may_gather and not self._scene.light_groups
        return is_wanted and can_gather and bool(self.kit.meshes.draws)

    def _make(self, commands: Commands) -> None:
        """Bring the hierarchy up to date, and the passes that look into it."""
        kit = self.kit
        if self._albedos is None:
            materials = {id(m.material): m.material for m in kit.meshes.original}
            self._albedos = Albedos(kit.gpu, list(materials.values()))
        rays = kit.rays.of_frame(commands)
        # Once something has moved, rays also meet instances.
        if self._trace is None or self._trace.constants != rays.constants:
            self._trace = Trace(kit.gpu, rays, self._albedos)
            media = self._air.media if self._air else None
            self._sky_rays = SkyRays(kit.gpu, rays, self._cells, media)
        self._lighting.shadows = kit.shadow_rays(commands)
        if self._mirrors is not None:
            self._mirrors.lighting.shadows = self._lighting.shadows

    def _fitted(self, size: tuple[int, int]) -> ViewBatches:
        if self._sized is None or self._sized.points.size != size:
            self._scope.release()
            self._sized = None
            has_air = self._air is not None
            self._sized = ViewBatches(
                self._scope, self.kit, size, self.settings, self._cells, has_air=has_air
            )
        return self._sized

    @property
    def stats(self) -> dict[str, Any]:
        """The rays of a point, for --stats."""
        return {"gather_rays": self.settings.gather_rays}
