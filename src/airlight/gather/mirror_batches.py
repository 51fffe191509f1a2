"""The images and lists of mirrored rays, batch by batch."""

from __future__ import annotations

from ..gpu.counted import CountedRows
from ..gpu.device import Gpu
from ..gpu.memory import Buffer, Texture
from ..lighting.gathered import Mirrored
from ..lighting.lighting import RadianceLayers
from ..lighting.view import View
from ..surface.hits import Hits
from .mirror_passes import MirrorParams
from .points import pixel_m

MOST_HITS = 1 << 17
"""Rays that are lit at once."""
_REACH = 0.02  # of the image's height, within which pixels share rays in the first sample


class MirrorEnds:
    """The rays of a segment: their pixels, where they start, what they meet, how many `rows`."""

    def __init__(self, gpu: Gpu, batch: tuple[int, int]) -> None:
        self.pixels = Buffer(gpu, "pixels of mirrored rays", 4 * batch[0] * batch[1])
        self.starts = Texture(gpu, "starts of mirrored rays", batch, "rgba32float", written=True)
        self.rows = CountedRows(gpu, "count of mirrored rays")
        self.hits = Hits(gpu, batch, self.rows)


class MirrorBatches:
    """What depends on the image's size, for paths of `segments`. `count`: rays of a batch."""

    def __init__(self, gpu: Gpu, size: tuple[int, int], segments: int, *, has_air: bool) -> None:
        self.size = size
        width, height = size
        # An image of hits holds this many rays.
        batch = (width, max(1, min(height, MOST_HITS // width)))
        self.count = batch[0] * batch[1]
        # Of the whole image: which pixels send rays, and what these found.
        self.found = Buffer(gpu, "mirroring pixels", 4 * (segments + 1))
        self.listed = Buffer(gpu, "list of mirroring pixels", 4 * width * height)
        self.senders = Texture(gpu, "senders of mirrored rays", size, "r32uint", written=True)
        self.ends, self.light = (
            Texture(gpu, label, size, "rgba32float", written=True)
            for label in ("ends of mirrored rays", "light of mirrored rays")
        )
        # What paths pass on and have found, from one segment to the next.
        self.throughputs = Buffer(gpu, "throughput of mirrored rays", 32 * width * height)
        # Of a batch: its rays, what they met, and how that is lit. Where paths go on, those of two
        # segments are there at once.
        self.batch = batch
        self._ends = [MirrorEnds(gpu, batch) for _ in range(min(segments, 2))]
        self.layers = RadianceLayers(gpu, batch)
        self.air = Buffer(gpu, "air along mirrored rays", 32 * self.count) if has_air else None
        # What pixels mirror in the end.
        sky, light = (
            Texture(gpu, label, size, "rgba32float", written=True)
            for label in ("mirrored sky", "mirrored light")
        )
        self.out = Mirrored(sky, light)

    def ends_of(self, segment: int) -> MirrorEnds:
        """Where rays of the segment end; of every second one in the same images."""
        return self._ends[segment % 2]

    def params(
        self,
        view: View,
        first: int,
        segment: int = 0,
        raised: float = 0.0,
        *,
        goes_on: bool = False,
    ) -> MirrorParams:
        """For the rows of the list from `first` on."""
        # Within a reach that shrinks from sample to sample pixels share rays.
        return MirrorParams(
            world_from_clip=view.world_from_clip,
            eye=view.eye,
            first=first,
            size=self.size,
            batch=self.batch,
            sample=view.number,
            reach=max(1.0, _REACH * self.size[1]) * (view.number + 1) ** -0.25,
            texel=pixel_m(view.world_from_clip, self.size[1]),
            segment=segment,
            raised=raised,
            goes_on=int(goes_on),
            pad=(0, 0),
        )
