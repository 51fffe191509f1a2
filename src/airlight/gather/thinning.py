"""How many rays of a point go on from segment to segment of their paths.

What first segments find is uneven, a small sunlit patch or none; what later ones bring is dimmer
and comes from all around: least noise for the time has about 1 / sqrt(2) as many rays of each
segment as of the one before (docs/decisions.md). The first rays of a sample go on, and each counts
for those that end (splitting, Arvo1990).
differs: Arvo1990 lets chance decide which paths end; here that is known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..gpu.device import Gpu
from ..lighting.lighting import RadianceLayers
from ..surface.hits import Hits


def rays_of(segment: int, rays: int) -> int:
    """How many of a point's `rays` in a sample have a `segment` of that number; one at least."""
    return max(1, math.ceil(rays / math.sqrt(2.0) ** segment))


def going_on(numbers: range, sample: range, segment: int) -> range:
    """Of the rays of a batch, those that have the `segment`; `sample`: all rays of a point."""
    # The first ones of the sample, whatever batches it comes in.
    last = sample.start + rays_of(segment, len(sample))
    return range(numbers.start, max(numbers.start, min(numbers.stop, last)))


def counts(segment: int, rays: int) -> float:
    """How many of the paths that have the `segment` each of those counts that have the next one."""
    return rays_of(segment, rays) / rays_of(segment + 1, rays)


@dataclass(frozen=True)
class Ends:
    """What the rays of a batch meet where a segment ends, and its light."""

    hits: Hits
    layers: RadianceLayers


class SegmentEnds:
    """The ends of each segment of a batch, made when first asked for."""

    def __init__(self, gpu: Gpu, reduced: tuple[int, int], batch: int, rays: int) -> None:
        """Of `reduced` points; `batch`: rays of each at once, of so many `rays` in a sample."""
        self._gpu, self._reduced, self._batch, self._rays = gpu, reduced, batch, rays
        self._ends: list[Ends] = []

    def of(self, segment: int) -> Ends:
        """Those of the segment of this number."""
        while len(self._ends) <= segment:
            # A texel for each ray that has such a segment.
            most = min(self._batch, rays_of(len(self._ends), self._rays))
            size = (self._reduced[0], self._reduced[1] * most)
            self._ends.append(Ends(Hits(self._gpu, size), RadianceLayers(self._gpu, size)))
        return self._ends[segment]
