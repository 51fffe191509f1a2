"""The segments of paths of a gather, one after the other: traced, attenuated, lit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..fields import Fields
from ..gpu.commands import Commands
from ..gpu.memory import Buffer, Texture
from ..lighting.hits import HitLighting, HitsInLight
from ..lighting.kit import Kit
from ..lighting.lighting import RadianceLayers
from ..surface.hits import Hits
from .air import Air, light_in
from .batches import CellBatches, ViewBatches
from .guide import LightGuide
from .paths import Lattices, SegmentLight
from .settings import GatherSettings
from .sky_cells import SkyCells
from .thinning import counts, going_on
from .trace import Segment, Trace


class PathSegments:
    """Follows the paths of batches; `trace` is the hierarchy's of the frame."""

    def __init__(
        self,
        kit: Kit,
        settings: GatherSettings,
        cells: SkyCells,
        lighting: HitLighting,
        air: Air | None,
        *,
        bounces: bool,
    ) -> None:
        """`bounces`: whether the lattices' light is on what rays meet."""
        self.kit, self.settings, self._cells = kit, settings, cells
        self._lighting, self._air, self._bounces = lighting, air, bounces
        self._guide = LightGuide(kit.gpu)
        self.trace: Trace | None = None

    @property
    def patches(self) -> Buffer:
        """Those that lead rays, as `LightGuide.patches`."""
        return self._guide.patches

    @property
    def is_any_later(self) -> bool:
        """Whether paths have more than one segment."""
        return self._bounces and self.settings.gather_bounces > 1

    def guided(self, commands: Commands, sized: ViewBatches, fields: Fields) -> int:
        """Find what lights shine on that points see; how many rays of each point go there."""
        if not sized.guided.count:
            return 0
        # Patches of what lights shine on, weighted by what points get of it.
        diagonal = float(np.linalg.norm(self.kit.box[1] - self.kit.box[0]))
        rays = self.kit.rays.of_frame(commands)
        with commands.stage("gather guide"):
            is_any = self._guide.encode(commands, fields.lit, sized.points, rays, diagonal)
        return sized.guided.count if is_any else 0

    def add_guided(
        self,
        commands: Commands,
        sized: ViewBatches,
        number: int,
        fields: Fields,
    ) -> None:
        """Trace rays towards what lights shine on, light what they meet and add that up."""
        assert self.trace is not None
        guided = sized.guided
        # Guided rays have numbers of their own, which go on from sample to sample.
        numbers = range(number * guided.count, (number + 1) * guided.count)
        segment = Segment(numbers, 0, self.kit.rays.raised)
        patches, hits = self._guide.patches, guided.hits
        with commands.stage("gather rays"):
            self.trace.encode_guided(commands, sized.points, hits, segment, patches)
        # Media attenuate what they find.
        if self._air is not None and guided.air is not None:
            self._pass_air(
                commands, sized, (sized.points.starts, hits), segment, fields, guided.air
            )
        # The same light as that of which rays by the cosine leave a part.
        count = self.settings.gather_bounces if self._bounces else 1
        with commands.stage("gather lighting"):
            told = self._told(count - 1, count)
            light = self._light(commands, guided.layers, hits, fields, told, is_last=count == 1)
            guided.encode(commands, light.lights, patches, sized.sums.buffer)

    def followed(
        self,
        commands: Commands,
        sized: ViewBatches | CellBatches,
        numbers: range,
        fields: Fields,
        guided: int = 0,
    ) -> Iterator[Segment]:
        """Trace paths of several segments; lattices light what the last of them meets.

        `numbers`: of a batch's rays. `guided`: rays of each point beside these that are led to what
        lights shine on.

        Yields the rays of each segment once its light is in the paths; none where nobody waits.
        """
        assert self.trace is not None
        rays = sized.rays
        count = self.settings.gather_bounces if self._bounces else 1
        first = rays * (numbers.start // rays)
        sample = range(first, first + rays)
        before = sized.ends.of(0).hits
        for index in range(count):
            # Later segments have fewer rays, none of some batches.
            along = going_on(numbers, sample, index)
            if not (along and commands.is_wanted):
                return
            # What each ray meets, from the surface that the one before it met.
            ends, is_last = sized.ends.of(index), index + 1 == count
            hits, weight = ends.hits, 1.0 if is_last else counts(index, rays)
            segment = Segment(along, index, self.kit.rays.raised, weight)
            with commands.stage("gather rays"):
                guide = self._guide.patches, sized.paths.buffer
                self.trace.encode(commands, sized.points, (before, hits), segment, guide)
            # What media along the segment scatter into it, and how much light they let by.
            if self._air is not None and sized.paths.air is not None:
                both = (sized.points.starts if index == 0 else before.positions, hits)
                self._pass_air(commands, sized, both, segment, fields, sized.paths.air)
            with commands.stage("gather lighting"):
                told = self._told(count - 1 - index, count)
                light = self._light(commands, ends.layers, hits, fields, told, is_last=is_last)
                patches = self._guide.patches, guided
                sized.paths.encode(commands, hits, light, segment, rays, told, patches)
            yield segment
            # The next segment starts where this one ended.
            before = hits

    def _told(self, left: int, count: int) -> Lattices:
        """What becomes of the lattices' light with so many segments `left` of `count`."""
        # Lattices stand for what no segment traces: at the end of the last one; and at that of the
        # one before, to compare both.
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
        light, what = self._lighting, HitsInLight(hits, layers, fields.sky)
        if not (is_asked or has_sky or forward):
            return SegmentLight(light.lights(commands, what, cache))
        # One field, or lattices' and forward light apart, the second beside the first.
        first = cache if is_asked else forward or self.kit.darkened(cache)
        if has_sky and not (is_asked and forward):
            light.encode(commands, what, first)
            lit, found = layers.direct, layers.indirect
        else:
            lit, found = light.apart(commands, what, first)
            lit = layers.direct if has_sky else lit
        # What lattices know has forward light in it, which is told beside it.
        if not is_asked:
            return SegmentLight(lit, forward=found if forward else None)
        if forward is None:
            return SegmentLight(lit, lattices=found)
        along = light.also(commands, what, forward)
        return SegmentLight(lit, along, found)

    def _pass_air(
        self,
        commands: Commands,
        sized: ViewBatches | CellBatches,
        ends: tuple[Texture, Hits],
        segment: Segment,
        fields: Fields,
        air: Buffer,
    ) -> None:
        """What media along a segment scatter into it, and how much light they let by."""
        assert self._air is not None
        with commands.stage("gather air"):
            # Rays of cells go through the media themselves, those of what they meet through
            # reduced ones.
            is_from_air = isinstance(sized, CellBatches) and segment.index == 0
            met = light_in(fields, is_from_air=is_from_air)
            self._air.encode(commands, sized.points.reduced, ends, segment, met, air)
