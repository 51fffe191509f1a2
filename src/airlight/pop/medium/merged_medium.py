"""Many volumes of a kind on one grid: their extinctions, added up by the device.

volumes -> kinds -> merging: box, mean coefficients, width -> merged.wgsl: extinction in fine cells
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, u32, vec3u, vec4u
from ...gpu.memory import Texture
from ...gpu.slots import image, uniform
from ...media.gpu_media import GpuMedia
from ...media.media_rows import member_bits
from ...scene.fingerprint import is_same
from ...scene.volume import Volume
from .grid_medium import NO_OTHERS, GridMedium
from .merging import merged_volume, merged_width
from .mixture import MediaCount
from .placement import FINE, PlacedVolume, placed

_SAMPLES = 2  # of the media along each axis of a fine cell
_MOST_SIDE = 64  # cells along a side of a cube, as of the setting `grid`


class MergedParams(Struct):
    """The fine cells, and what is density 1."""

    world_from_uvw = mat4x4f()
    count = vec3u("fine cells")
    samples = u32("along each axis of one")
    scale = f32("m, density per extinction")
    reach = f32("m, from the middle of a fine cell to its corners")
    members_low = vec4u("bits of the media, see wgsl/members.wgsl")
    members_high = vec4u()


class _Merged(ComputePass):
    workgroup = (8, 8, 1)
    file = "merged.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (
            uniform("params", MergedParams),
            image("voxels", "rgba16float", "3d"),
            *media.medium_slots,
        )
        super().__init__(gpu, generated=media.medium_wgsl)


class MergedMedium(GridMedium):
    """Some `media` on one grid, of a number of cells that stays. It follows the volumes."""

    def __init__(
        self,
        gpu: Gpu,
        media: GpuMedia,
        volumes: Sequence[Volume],
        cells: float,
        *,
        rows: Sequence[int],
        others: MediaCount = NO_OTHERS,
    ) -> None:
        """About so many `cells`. `volumes`: those that `media` hold in `rows`, brought up to date
        there. `others`: media on grids of their own beside this one."""
        self._media, self._pass, self._filled = media, _Merged(gpu, media), -1
        self.rows = tuple(rows)
        # About as many cells as asked for, over the box of all volumes.
        side = min(float(np.cbrt(cells)), _MOST_SIDE)
        self._of, self._whole_volume = tuple(volumes), merged_volume(volumes)
        self._placement = placed(self._whole_volume, int(side))
        size = self._placement.fine_count
        self._merged = Texture(
            gpu, "merged media", size, "rgba16float", dimension="3d", written=True
        )
        super().__init__(gpu, [self._whole_volume], 0, voxels=self._merged, others=others)

    def volume_of(self, volumes: Sequence[Volume]) -> Volume:
        """The medium that these are, which are of the first ones' number; `take` takes it."""
        # The same volumes give the same object, which the solver takes for unchanged.
        if not is_same(volumes, self._of):
            self._of, self._whole_volume = tuple(volumes), merged_volume(volumes)
        return self._whole_volume

    def _placed(self, parts: Sequence[Volume]) -> list[PlacedVolume]:
        # As many cells as at first along each side, however the volumes moved.
        (whole,) = parts
        placement = replace(placed(whole, 2), count=self._placement.count)
        return [PlacedVolume(whole, placement, merged_width(self._of, whole))]

    def encode(self, commands: Commands) -> bool:
        """Add the media up where any changed; returns whether any did."""
        # The version of the table of media says whether any of them changed.
        if self._media.version == self._filled:
            return super().encode(commands)
        self._filled, self._key = self._media.version, ()
        # Density 1 is the mean extinction of the three channels.
        with commands.stage("pop density"):
            self._pass.dispatch(
                commands,
                self._merged.size,
                params=MergedParams(
                    world_from_uvw=np.linalg.inv(self.placement.uvw_from_world),
                    count=self._merged.size,
                    samples=_SAMPLES,
                    scale=1.0 / max(float(np.mean(self.volume.sigma_t)), 1e-30),
                    reach=float(np.linalg.norm(self.placement.cell)) / (2 * FINE),
                    **member_bits(self.rows),
                ),
                voxels=self._merged,
                **self._media.medium_bound,
            )
        return super().encode(commands)
