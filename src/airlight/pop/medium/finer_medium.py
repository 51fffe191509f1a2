"""A part of a medium on a finer grid, which follows the camera."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...maths.transforms import F64
from ...scene.volume import Volume
from .grid_medium import GridMedium
from .nesting import finer_cells, placed_ahead
from .placement import PlacedVolume


class FinerMedium(GridMedium):
    """The medium of `whole` in the cells of a grid that is finer than that of `of`.

    `grid`: where it is. Its light enters from the solution of `of`.
    """

    def __init__(self, of: GridMedium, ratio: float) -> None:
        """`ratio`: of the sides of cells, from each grid to the next finer one."""
        self.of, self._whole, self.level = of, of.whole, of.level + 1
        # It begins in the middle of the medium, until the camera is known.
        placement = self._whole.placement
        self._finer_cells = finer_cells(placement, self.level, ratio)
        middle = placement.world_from_medium @ np.array([*(0.5 * placement.extent), 1.0])
        self.grid = placed_ahead(placement, self._finer_cells, middle[:3], np.zeros(3), None)
        super().__init__(of.gpu, of.volumes, 0, voxels=of.voxels[0])

    def _placed(self, parts: Sequence[Volume]) -> list[PlacedVolume]:
        # The whole medium has taken them already.
        return self._whole.moved_to(self.grid.placement)

    @property
    def whole(self) -> GridMedium:
        """The largest grid of the same volume."""
        return self._whole

    @property
    def offset(self) -> F64:
        """Its lower corner (3,), m in the frame of the next larger grid."""
        outer = self.of.grid.offset if isinstance(self.of, FinerMedium) else 0.0
        return np.asarray(self.grid.offset - outer)

    def follow(self, eye: F64, look: F64) -> None:
        """Move ahead of `eye` along `look`, both (3,) of the world, in whole cells."""
        self.grid = placed_ahead(self._whole.placement, self._finer_cells, eye, look, self.grid)
