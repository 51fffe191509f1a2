"""What mirrors and glossy surfaces show, along rays of their pixels.

list -> a ray of each listed pixel -> what it meets, lit as pixels are -> another ray where that is
metal or a smooth coat -> shared between pixels as far as their lobes are wide -> radiance
"""

from __future__ import annotations

from ..area.lighting import cosines
from ..fields import Fields
from ..gpu.commands import Commands
from ..lighting.gathered import Mirrored
from ..lighting.hits import HitLighting, HitsInLight
from ..lighting.kit import Kit
from ..lighting.view import View
from ..rays.rays import RayScene
from .air import Air, light_in
from .albedo import Albedos
from .glosses import Glosses
from .mirror_batches import MirrorBatches, MirrorEnds
from .mirror_passes import (
    KINDS,
    Counting,
    FirstRays,
    LaterRays,
    Listing,
    MirrorLight,
    MirrorParams,
    Resolving,
)
from .trace import Segment


class Mirrors:
    """Follows mirrored rays. `lighting` lights what they meet, `air` is what they go through."""

    def __init__(self, kit: Kit, lighting: HitLighting, air: Air | None, segments: int) -> None:
        """As for `GatherSolver`. `segments`: of a path from mirror to mirror, at most."""
        gpu = kit.gpu
        self._kit, self.lighting, self._air = kit, lighting, air
        # Which pixels mirror, the light of what their rays meet, and how pixels share it.
        self._list, self._light = Listing(gpu), MirrorLight(gpu, has_air=air is not None)
        self._counting = Counting(gpu)
        self._resolve = Resolving(gpu, generated=KINDS)
        # Without metal no path goes on from mirror to mirror.
        self._glosses = Glosses(gpu, kit.meshes.original)
        self._segments = segments if self._glosses.mirrors else 1
        self._cosines = cosines(gpu)  # for the albedo of what is mirrored
        self._rays: tuple[dict[str, float], FirstRays, LaterRays] | None = None
        self._scope = gpu.scope()
        self._sized: MirrorBatches | None = None

    def encode(
        self, commands: Commands, view: View, fields: Fields, rays: RayScene, albedos: Albedos
    ) -> Mirrored:
        """What the view's pixels mirror; its G-buffer is drawn."""
        # Kernels are others once a mesh has moved.
        if self._rays is None or self._rays[0] != rays.constants:
            gpu, constants = self._kit.gpu, rays.constants
            self._rays = (
                constants,
                FirstRays(gpu, constants=constants),
                LaterRays(gpu, constants=constants),
            )
        # What glows may be another, and so may the image's size.
        self._glosses.follow(self._kit.meshes.current)
        sized = self._fitted(view.size)
        pixels = {**view.gbuffer.bound}
        # Which pixels send rays: they are listed, and `senders` says whose ray each pixel shows.
        with commands.stage("mirrored rays"):
            commands.encoder.clear_buffer(sized.found.handle)
            self._list.dispatch(
                commands,
                view.size,
                params=sized.params(view, 0),
                **pixels,
                found=sized.found,
                listed=sized.listed,
                senders=sized.senders,
            )
        # Rays of the listed pixels, as many at once as the images of hits hold.
        for first in range(0, view.size[0] * view.size[1], sized.count):
            self._follow(commands, view, fields, first, (rays, albedos))
        # Each pixel takes its own ray and those of pixels around, by its own lobe.
        with commands.stage("mirrored rays"):
            self._resolve.dispatch(
                commands,
                view.size,
                params=sized.params(view, 0),
                **pixels,
                senders=sized.senders,
                mirrored_ends=sized.ends,
                mirrored_found=sized.light,
                cosines=self._cosines,
                mirrored_sky=sized.out.sky,
                mirrored_light=sized.out.light,
            )
        return sized.out

    def _follow(
        self,
        commands: Commands,
        view: View,
        fields: Fields,
        first: int,
        met: tuple[RayScene, Albedos],
    ) -> None:
        """Trace and light a batch of the list's rays, segment by segment."""
        assert self._rays is not None and self._sized is not None
        sized = self._sized
        for index in range(self._segments):
            # A segment's hits are the next one's starts: two sets of buffers, in turn.
            goes_on = index + 1 < self._segments
            params = sized.params(view, first, index, self._kit.rays.raised, goes_on=goes_on)
            ends = sized.ends_of(index)
            given = {
                **met[0].bound,
                **met[1].bound,
                "params": params,
                "found": sized.found,
                "next_pixels": ends.pixels,
                "next_starts": ends.starts,
                "hit_positions": ends.hits.positions,
                "hit_normals": ends.hits.normal,
                "hit_albedos": ends.hits.albedo,
            }
            with commands.stage("mirrored rays"):
                # The first segment starts at pixels that mirror, others where the one before ended.
                if index == 0:
                    self._count(commands, params, ends)
                    self._rays[1].dispatch_indirect(
                        commands,
                        ends.rows.arguments,
                        depth=view.gbuffer.bound["depth"],
                        normal=view.gbuffer.bound["normal"],
                        listed=sized.listed,
                        **given,
                    )
                else:
                    before = sized.ends_of(index - 1)
                    self._rays[2].dispatch_indirect(
                        commands,
                        before.rows.arguments,
                        pixels=before.pixels,
                        starts=before.starts,
                        met_positions=before.hits.positions,
                        met_normals=before.hits.normal,
                        glosses=self._glosses.rows,
                        **given,
                    )
                    self._count(commands, params, ends)
            self._light_hits(commands, fields, params, ends)

    def _count(self, commands: Commands, params: MirrorParams, ends: MirrorEnds) -> None:
        """Tell later passes how many rays a segment has."""
        assert self._sized is not None
        self._counting.dispatch(
            commands,
            (1,),
            params=params,
            found=self._sized.found,
            arguments=ends.rows.arguments,
        )

    def _light_hits(
        self,
        commands: Commands,
        fields: Fields,
        params: MirrorParams,
        met: MirrorEnds,
    ) -> None:
        """Add the light of what a segment met, as far as it passes the media on its path."""
        assert self._sized is not None
        sized, hits, air = self._sized, met.hits, {}
        # Media along the rays: their light, and their transmittance.
        if self._air is not None and sized.air is not None:
            with commands.stage("mirrored rays"):
                ends, whole = (met.starts, hits), Segment(range(1), 0, 0.0)
                along = light_in(fields, is_mirrored=True)
                self._air.encode(commands, hits.size, ends, whole, along, sized.air)
                air = {"air": sized.air}
        with commands.stage("mirrored light"):
            # Hits lit as pixels are, by lights and by lattices.
            cache, lit = fields.irradiance or self._kit.no_irradiance, sized.layers.direct
            what = HitsInLight(hits, sized.layers, fields.sky)
            if self._segments > 1:
                lit, _ = self.lighting.apart(commands, what, cache)
            else:
                self.lighting.encode(commands, what, cache)
            # Their radiance goes to the pixel that sent the ray, or on along the next ray.
            self._light.dispatch_indirect(
                commands,
                met.rows.arguments,
                params=params,
                pixels=met.pixels,
                starts=met.starts,
                hit_positions=hits.positions,
                hit_normals=hits.normal,
                hit_albedos=hits.albedo,
                lit=lit,
                direct_light=sized.layers.direct,
                indirect_light=sized.layers.indirect,
                found=sized.found,
                **air,
                glosses=self._glosses.rows,
                cosines=self._cosines,
                throughputs=sized.throughputs,
                mirrored_ends=sized.ends,
                mirrored_found=sized.light,
            )

    def _fitted(self, size: tuple[int, int]) -> MirrorBatches:
        if self._sized is None or self._sized.size != size:
            self._scope.release()
            self._sized = None
            has_air = self._air is not None
            self._sized = MirrorBatches(self._scope, size, self._segments, has_air=has_air)
        return self._sized
