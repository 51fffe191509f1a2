"""Finer grids inside a medium's own, ahead of the camera: where they are.

Each has as many cells as the next larger one, smaller by a ratio, and moves in whole cells of its
own, as nested lattices do (`lattice.nested`, Kaplanyan2010 section 4). Elek2014 section 8 leaves
nested grids for principal ordinates to future work.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...lattice.nested import MARGIN, Nest, faded, snapped, wanted_centre
from ...lattice.placement import Fade, Placement
from ...maths.transforms import F64, triple
from .placement import MediumPlacement


@dataclass(frozen=True, eq=False)
class FinerGrid:
    """A finer grid, and where it fades into the next larger one; both in the largest one's frame.

    `level`: its cells, which are cubes, metres. `whole`: the medium's own grid.
    """

    whole: MediumPlacement
    level: Placement

    @property
    def offset(self) -> F64:
        """Its lower corner (3,), m in the frame of the medium's own grid."""
        return np.array(self.level.origin)

    @property
    def placement(self) -> MediumPlacement:
        """Its box of cells, as passes over a medium want it."""
        # The medium's own frame, from another corner.
        moved = np.eye(4)
        moved[:3, 3] = self.offset
        return MediumPlacement(
            self.whole.world_from_medium @ moved,
            self.whole.unit_from_medium @ moved,
            self.level.cell * np.array(self.level.count, np.float64),
            self.level.count,
        )

    @property
    def shares(self) -> Fade:
        """Where its light fades in and out, in shares of its box."""
        # The borders are metres in the medium's frame; marching reads shares of this grid's box.
        fade, extent = self.level.borders, self.placement.extent
        low, high = (np.array(x) - self.offset for x in (fade.low, fade.high))
        low_width, high_width = np.array(fade.low_width), np.array(fade.high_width)
        of_box = (triple(x / extent) for x in (low, low_width, high, high_width))
        return Fade(*of_box)


def finer_cells(whole: MediumPlacement, level: int, ratio: float) -> Placement:
    """The cells of the grid that is finer than `whole` by ratio^level, in its lower corner."""
    # Cells shrink by the ratio at each level; no grid has more of them than the medium's own.
    cell = float(whole.cell.min()) / ratio**level
    needed = np.ceil(whole.extent / cell - 1e-9).astype(int) + 2 * MARGIN
    count = np.minimum(needed, whole.count)
    return Placement((0.0, 0.0, 0.0), cell, (int(count[0]), int(count[1]), int(count[2])))


def placed_ahead(
    whole: MediumPlacement, cells: Placement, eye: F64, look: F64, before: FinerGrid | None
) -> FinerGrid:
    """A grid of `cells` ahead of `eye` along `look`, both of the world; `before`: the last one.

    Inside the medium's box: for an eye outside on the side that it sees. It moves in whole cells.
    """
    # Nested lattices' own rules place it, with the medium's box as the largest level.
    corner = Placement((0.0, 0.0, 0.0), float(whole.cell.min()), whole.count)
    nest = Nest((0.0, 0.0, 0.0), triple(whole.extent), (cells, corner))
    # An eye at the middle of a medium's box lies ahead of it, whatever the size of both.
    centre = wanted_centre(nest, 0, whole.point(eye), whole.direction(look))
    moved = snapped(nest, 0, centre, before.level if before else None)
    return FinerGrid(whole, faded(nest, 0, moved, centre))
