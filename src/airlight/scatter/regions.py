"""Slow light, brought between regions of a lattice at once.

Light that finds its way around walls takes hundreds of steps. A lattice is parted into at most 64
regions, each of the cells that are nearest to where it begins, through faces that are open both
ways, so that no region reaches through a wall. Each box of a grid begins one, and another one where
a wall keeps cells of it from the first ones. All cells of a region are taken to have the same
power; what a region then keeps and sends to others in a step depends on walls and media alone, and
the sum over all steps to come is the inverse of a small matrix. After a step the power that it
brought to each region, times that inverse, is added to the cells (maths.regions is the NumPy twin).
Source: ours, after aggregation (Koury1984). Cells that none reaches are left to the steps.

    walls --flood, sort--> regions, members         media, walls --exchange, invert--> matrix
    step --missing--> power under way --shares--> per region --apply--> cells
"""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.placement import LatticeSize
from ..maths.regions import FLOOD_STEPS, REGIONS, region_grid
from .coefficients import CHANNELS
from .propagate import Operator, StepMedium
from .region_passes import (
    RUN,
    Apply,
    Count,
    Exchange,
    Flood,
    FloodParams,
    Invert,
    Missing,
    Scan,
    Seeds,
    Shares,
    Sort,
    SortParams,
)


class Regions:
    """The regions of one lattice, and corrections of its sum."""

    def __init__(
        self, gpu: Gpu, count: tuple[int, int, int], *, has_walls: bool, is_varied: bool
    ) -> None:
        cells = count[0] * count[1] * count[2]
        self._count, self._grid, self._has_walls = count, region_grid(count), has_walls
        self._runs = -(-cells // RUN)
        self._sorted = SortParams.of(cells=cells, runs=self._runs)
        # The region of each cell, in turn; cells by region, and where each begins.
        self.regions, self._spare, self._members = (
            Buffer(gpu, name, cells * 4) for name in ("regions", "regions before", "members")
        )
        self._seeds = Buffer(gpu, "where regions begin", REGIONS * 8)
        self._firsts = Buffer(gpu, "firsts of regions", self._runs * REGIONS * 4)
        self._starts = Buffer(gpu, "starts of regions", (REGIONS + 1) * 4)
        # Light between regions; what is under way, and what comes of it.
        self.matrix = Buffer(gpu, "light between regions", CHANNELS * REGIONS * REGIONS * 4)
        self._missing, self._shares = (
            Buffer(gpu, f"{name} of regions", CHANNELS * REGIONS * 4)
            for name in ("missing power", "shares")
        )
        kind = {"HAS_WALLS": float(has_walls), "IS_VARIED": float(is_varied), "HANDED_ON": 0.0}
        self._seed, self._flood, self._invert = Seeds(gpu), Flood(gpu), Invert(gpu)
        self._sorting = Count(gpu), Scan(gpu), Sort(gpu)
        self._exchange = Exchange(gpu, constants=kind)
        self._passes = Missing(gpu), Shares(gpu), Apply(gpu)

    def take_walls(self, commands: Commands, face_visibility: Buffer) -> None:
        """Find the regions of the cells; `face_visibility` as lattice.blockers has it."""
        self._flood_cells(commands, face_visibility)
        # Their cells, in the order of cells.
        params, runs = self._sorted, (self._runs,)
        firsts, regions = self._firsts, self.regions
        count, scan, sort = self._sorting
        count.dispatch(commands, runs, params=params, regions=regions, firsts=firsts)
        scan.dispatch(commands, (REGIONS,), params=params, firsts=firsts, starts=self._starts)
        sort.dispatch(
            commands, runs, params=params, regions=regions, firsts=firsts, members=self._members
        )

    def _flood_cells(self, commands: Commands, face_visibility: Buffer) -> None:
        """Write the region of each cell: the nearest beginning that open faces lead to."""
        # From where regions begin through open faces; then from where they begin in cells that none
        # has reached. The number of steps is even: the last is in `regions`.
        before, after = self.regions, self._spare
        size, boxes = self._count, (int(np.prod(self._grid)) * Seeds.workgroup[0],)
        for turn in range(2):
            for step in range(FLOOD_STEPS + 1):
                params = FloodParams.of(
                    count=self._count,
                    step=step,
                    regions=self._grid,
                    has_walls=int(self._has_walls),
                    turn=turn,
                )
                bound = {"params": params, "face_visibility": face_visibility, "seeds": self._seeds}
                if step == 0:
                    self._seed.dispatch(commands, boxes, **bound, regions=before)
                self._flood.dispatch(commands, size, **bound, before=before, after=after)
                before, after = after, before

    def take_medium(self, commands: Commands, lattice: StepMedium) -> None:
        """Find what regions send each other through walls and media as they are."""
        self._exchange.dispatch(
            commands,
            (REGIONS * REGIONS, CHANNELS),
            params=lattice.params(Operator.MOVE, slabs=1),
            coefficients=lattice.coefficients,
            medium=lattice.medium,
            packs=lattice.packs,
            regions=self.regions,
            members=self._members,
            starts=self._starts,
            matrix=self.matrix,
        )
        self._invert.dispatch(
            commands, (CHANNELS * REGIONS,), starts=self._starts, matrix=self.matrix
        )

    def correct(self, commands: Commands, *, current: Buffer, stepped: Buffer) -> None:
        """Add to `stepped`, a step on from `current`, what later steps will bring to regions."""
        missing, shares, apply = self._passes
        size = LatticeSize.of(count=self._count)
        # The power that the step brought to each region, summed over its cells.
        missing.dispatch(
            commands,
            (REGIONS * REGIONS, CHANNELS),
            params=size,
            members=self._members,
            starts=self._starts,
            stepped=stepped,
            sum=current,
            missing=self._missing,
        )
        # Times the matrix: what of it will come to each cell of each region.
        shares.dispatch(
            commands,
            (CHANNELS * REGIONS,),
            matrix=self.matrix,
            missing=self._missing,
            shares=self._shares,
        )
        # And that is there now.
        nx, ny, nz = self._count
        apply.dispatch(
            commands,
            (nx, ny, CHANNELS * nz),
            params=size,
            regions=self.regions,
            shares=self._shares,
            stepped=stepped,
        )
