"""Batches of rays, as large as the device holds: their points, hits, paths, sums and filters.

A view's pixels and the cells of media are gathered by the same rays; what they start from, and
what becomes of their sums, differs.
"""

from __future__ import annotations

from typing import Any

from ..fields import AirLight
from ..gpu.device import Gpu
from ..lattice.placement import Placement
from ..lighting.kit import Kit
from ..lighting.view import View
from ..media.gpu_media import GpuMedia
from .calibration import RAYS
from .cells import CellPoints, CellSums, rows_of
from .filtering import Filtering
from .found import FoundSums
from .guided import GuidedRays
from .history import History
from .later import LaterLight
from .paths import Paths
from .points import Points
from .seen_cells import FIRST, TURNS, SeenCells, seen_cells
from .settings import GatherSettings
from .sky_cells import SkyCells
from .sums import Sums
from .thinning import SegmentEnds
from .upsample import Upsampling

MOST_HITS = 1 << 20
"""Of a batch: 290 bytes for each, with those of later segments."""


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
        most = gpu.limits["max-texture-dimension-2d"] // self.points.reduced[1]
        self.batch = max(min(rays, RAYS), min(rays, most, MOST_HITS // self.points.count))
        self.ends = SegmentEnds(gpu, self.points.reduced, self.batch, rays)
        # Paths of rays by the cosine, and beside them rays that patches lead.
        self.paths = Paths(gpu, self.points, cells, self.batch, has_air=has_air)
        guided = settings.gather_guided
        self.guided = GuidedRays(gpu, self.points, rays, guided, has_air=has_air)
        # What becomes of their light.
        self.later = LaterLight(gpu, self.points, self.batch, rays)
        self.sums, self.found = Sums(gpu, self.points), FoundSums(gpu, self.points, rays)
        self.filtering = Filtering(gpu, self.points, rays)
        self.upsampling = Upsampling(gpu, kit, self.points, rays)
        most = settings.gather_history
        self.history = History(gpu, self.points, most) if most else None


class CellBatches:
    """Of the cells of lattices that send rays; what samples before found in all of them."""

    def __init__(
        self, scope: Gpu, kit: Kit, cells: int, rays: int, sky: SkyCells, media: GpuMedia
    ) -> None:
        """`cells` of all lattices; `rays` that a cell in sight sends in a sample, on the mean of
        all, if so many fit."""
        self._kit, self._sky, self._media, self.cells = kit, sky, media, cells
        # As many rays of every cell at once as an image of hits can hold, however many are seen.
        most = kit.gpu.limits["max-texture-dimension-2d"] // rows_of(cells)
        most = min(most, MOST_HITS // cells)
        # Half of them are sent from a point of its own, half from others of cells near the eye.
        self.rays = max(1, min(-(-rays // 2), most // 2))
        self._each = 2 if min(rays, most) > 1 else 1
        self.sums = CellSums(scope, cells, kit.lattices.texture_size)
        self.found: AirLight | None = None
        self._given: AirLight | None = None
        self._sample, self._number = -1, 0
        # Buffers are made once it is known how many cells are seen.
        self._scope = scope.scope()
        self._rows = 0
        self._looked: tuple[Any, ...] | None = None
        self._seen: SeenCells | None = None

    def look(self, view: View, placements: tuple[Placement, ...]) -> SeenCells:
        """The cells of these lattices that send rays in this sample; all is made for them."""
        turn = (view.sample - FIRST) % TURNS if view.sample >= FIRST else None
        # Jitter within a pixel does not count, what a lens moves the image by does.
        x, y = view.jitter_px
        looked = (placements, view.camera, view.size, (float(round(x)), float(round(y))), turn)
        if self._seen is None or looked != self._looked:
            seen = seen_cells(*looked, self._each)
            self._fit(rows_of(seen.cells.size))
            self.points.write(seen)
            self.sums.write(seen)
            self._looked, self._seen = looked, seen
        return self._seen

    def _fit(self, rows: int) -> None:
        """Make points for so many rows of them, and what their rays need."""
        if rows == self._rows:
            return
        self._scope.release()
        self._rows, gpu = rows, self._scope
        self.points = CellPoints(gpu, rows, self._media)
        self.ends = SegmentEnds(gpu, self.points.reduced, self.rays, self.rays)
        self.paths = Paths(gpu, self.points, self._sky, self.rays, has_air=True)

    def number_of(self, sample: int, given: AirLight) -> int:
        """How many samples in a row there were of this light before this one."""
        # Samples that follow one another in the light of one solve add up; others begin again.
        is_next = given is self._given and sample == self._sample + 1
        self._number = self._number + 1 if is_next and sample else 0
        self._given, self._sample = given, sample
        return self._number
