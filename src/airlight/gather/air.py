"""Media along the rays of a gather: they dim what lies behind, and scatter light into the rays.

Their light comes from `fields.AirLight` of a lattice, or from the sources of principal ordinates.
Rays from cells of a lattice meet its media as they are. For rays from surfaces all is as reduced
media have it (similarity theory): light that media scatter forwards alone goes on from lights as
beams, which no ray meets; `fields.forward` is its irradiance. Mirrored rays meet volumes of
principal ordinates as they are seen.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from ..fields import Fields
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec2u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..media.gpu_media import GpuMedia
from ..media.march.kernel import LOBE_SLOTS, MAX_LEVELS_AT_ONCE, Variant, field_slots
from ..media.march.kernel_wgsl import emission_wgsl
from ..media.march.march import March, Steps, march_params
from ..media.march.marched_light import MarchedLight, fading_of
from ..surface.hits import Hits
from .trace import Segment

STEPS = Steps(per_cell=0.5, most=24)
"""Irradiance is a mean over all directions, in which what coarser steps miss cancels."""


class AirParams(Struct):
    """How many points and rays there are, and which segment of the paths it is."""

    reduced = vec2u("points")
    rays = u32("of a point")
    segment = u32()
    is_reduced = u32("1: of all media; else of those that are not solved as sources")
    has_lobes = u32("1: of lattices the media themselves, whose light goes about some way")
    shows_glow = u32("1: rays meet what media emit; else that is left to the lights they are")


_FIRST = "fn first_lattices() -> LatticeParams { return lattices[0]; }\n"


class _Air(ComputePass):
    workgroup = (8, 8, 1)
    in_bands = True

    def __init__(self, gpu: Gpu, media: GpuMedia, variant: Variant) -> None:
        self.slots = (
            uniform("params", AirParams),
            texture("starts", "2d", "unfilterable-float"),
            texture("reached", "2d", "unfilterable-float"),
            *field_slots(media, variant),
            storage("air", "vec4f", "read_write"),
        )
        generated = media.medium_wgsl + emission_wgsl(variant)
        super().__init__(gpu, generated=generated + (_FIRST if variant.has_lattice else ""))


class Air:
    """Two vec4f for each ray of a batch: the light that is scattered into it, and what passes."""

    def __init__(self, gpu: Gpu, media: GpuMedia, *, sources: int = 0) -> None:
        """`sources`: the most textures of emission there will be."""
        self._gpu, self.media = gpu, media
        # Tables of sources and lattices as marching has them; another kernel reads them here.
        self._fields = March(gpu, media, sources=sources)
        self._passes: dict[Variant, _Air] = {}

    def encode(
        self,
        commands: Commands,
        reduced: tuple[int, int],
        ends: tuple[Texture, Hits],
        segment: Segment,
        met: Met,
        air: Buffer,
    ) -> None:
        """Fill `air` for rays of `reduced` points. `ends`: where the segments of paths
        start, and the hits where they end."""
        (starts, hits), light = ends, met.light
        lattice = light.lattice
        # One kernel for each number of sources and lattices, made when it is first needed.
        levels = min(len(lattice.levels), MAX_LEVELS_AT_ONCE) if lattice else 1
        variant = Variant(
            len(light.sources),
            fading_of(light.sources),
            ("lobes" if met.lobes else "mean") if lattice else "none",
            levels=levels,
        )
        if variant not in self._passes:
            self._passes[variant] = _Air(self._gpu, self.media, variant)
        # Steps are as long as the finest cells that they read allow.
        cells = [s.cell_m for s in (*light.sources, lattice) if s is not None]
        kernel = self._passes[variant]
        size = (reduced[0], reduced[1] * len(segment.numbers))
        kernel.dispatch_rows(
            commands,
            size,
            hits.rows,
            params=AirParams(
                reduced=reduced,
                rays=len(segment.numbers),
                segment=segment.index,
                is_reduced=int(met.is_reduced),
                has_lobes=int(met.lobes is not None),
                shows_glow=int(met.shows_glow),
            ),
            march=march_params(light, STEPS, min(cells, default=math.inf)),
            starts=starts,
            reached=hits.positions,
            **self.media.medium_bound,
            **self._fields.bound(variant, light),
            **(dict(zip(LOBE_SLOTS, met.lobes, strict=True)) if met.lobes else {}),
            air=air,
        )


class Met(NamedTuple):
    """Light that media along rays scatter, and whether all media there count as reduced ones.

    `shows_glow`: whether rays meet what media emit, too. `lobes`: the textures of where lattices'
    light goes (`LOBE_SLOTS`), for rays through their media themselves.
    """

    light: MarchedLight
    is_reduced: bool
    shows_glow: bool
    lobes: tuple[Texture, ...] | None = None


def light_in(fields: Fields, *, is_mirrored: bool = False, is_from_air: bool = False) -> Met:
    """The light that media scatter along a gather's rays, or along mirrored ones.

    `is_from_air`: along rays of the cells of lattices.
    """
    # Mirrored rays show volumes as the eye sees them, other rays what reduced media scatter.
    means = [None if is_mirrored else s.mean for s in fields.volumes]
    # Of volumes either all send what reduced media do, or all as they are seen from the eye.
    is_reduced = all(mean is not None for mean in means)
    sources = tuple(
        replace(s, texture=(mean if is_reduced else None) or s.whole or s.texture)
        for s, mean in zip(fields.volumes, means, strict=True)
    )
    light = MarchedLight(sources, fields.air.mean if fields.air else None)
    # What media emit reaches surfaces and cells as light of emitters, which mirrors do not show.
    lobes = None
    if is_from_air and fields.air:
        one = fields.air.lobes
        lobes = (one.straight, one.along, one.scattered_along)
    return Met(light, is_reduced, is_mirrored, lobes)
