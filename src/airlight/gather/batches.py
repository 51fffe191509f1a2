"""Batches of rays, as large as the device holds: their points, hits, paths, sums and filters.

A view's pixels and the cells of media are gathered by the same rays; what they start from, and
what becomes of their sums, differs.
"""

from __future__ import annotations

from ..fields import AirLight
from ..gpu.device import Gpu
from ..lighting.kit import Kit
from ..lighting.lighting import RadianceLayers
from ..media.gpu_media import GpuMedia
from ..surface.hits import Hits
from .calibration import RAYS
from .cells import CellPoints, CellSums
from .filtering import Filtering
from .guided import GuidedRays
from .history import History
from .paths import Paths
from .points import Points
from .settings import GatherSettings
from .sky_cells import SkyCells
from .sums import Sums
from .upsample import Upsampling

MOST_HITS = 1 << 20
"""Of a batch: 196 bytes for each."""


class ViewBatches:
    """Of a view's points, as many as its image asks for; `batch`: rays of each at once."""

    def __init__(
        self,
        gpu: Gpu,
        kit: Kit,
        size: tuple[int, int],
        settings: GatherSettings,
        cells: SkyCells,
        *,
        has_air: bool,
    ) -> None:
        rays, is_occluded = settings.gather_rays, kit.settings.ambient_occlusion
        self.rays = rays
        # A point of the image for each block of pixels.
        self.points = Points(gpu, size, is_occluded=is_occluded)
        # As many rays of every point at once as an image of hits can hold.
        width, height = self.points.reduced
        most = gpu.limits["max-texture-dimension-2d"] // height
        self.batch = max(min(rays, RAYS), min(rays, most, MOST_HITS // self.points.count))
        hits = (width, height * self.batch)
        self.hits, self.layers = (Hits(gpu, hits), Hits(gpu, hits)), RadianceLayers(gpu, hits)
        # Paths of rays by the cosine, and beside them rays that patches lead.
        self.paths = Paths(gpu, self.points, cells, self.batch, has_air=has_air)
        guided = settings.gather_guided
        self.guided = GuidedRays(gpu, self.points, rays, guided, has_air=has_air)
        # What becomes of their light.
        self.sums, self.filtering = Sums(gpu, self.points), Filtering(gpu, self.points, rays)
        self.upsampling = Upsampling(gpu, kit, self.points, rays)
        most = settings.gather_history
        self.history = History(gpu, self.points, most) if most else None


class CellBatches:
    """Of so many `cells` of lattices; `rays` of each at once, and what samples before found."""

    def __init__(
        self, gpu: Gpu, kit: Kit, cells: int, rays: int, sky: SkyCells, media: GpuMedia
    ) -> None:
        self.cells, self.points = cells, CellPoints(gpu, cells, media)
        # As many rays of every point at once as an image of hits can hold.
        width, height = self.points.reduced
        most = gpu.limits["max-texture-dimension-2d"] // height
        self.rays = max(1, min(rays, most, MOST_HITS // self.points.count))
        hits = (width, height * self.rays)
        self.hits, self.layers = (Hits(gpu, hits), Hits(gpu, hits)), RadianceLayers(gpu, hits)
        self.paths = Paths(gpu, self.points, sky, self.rays, has_air=True)
        self.sums = CellSums(gpu, self.points, kit.lattices.texture_size)
        self.found: AirLight | None = None
        self._given: AirLight | None = None
        self._sample, self._number = -1, 0

    def number_of(self, sample: int, given: AirLight) -> int:
        """How many samples in a row there were of this light before this one."""
        # Samples that follow one another in the light of one solve add up; others begin again.
        is_next = given is self._given and sample == self._sample + 1
        self._number = self._number + 1 if is_next and sample else 0
        self._given, self._sample = given, sample
        return self._number
