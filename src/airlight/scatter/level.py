"""One lattice of the stack that multigrid cycles go through: its size and its buffers."""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from .coefficients import CHANNELS
from .hop_visibility import new_packs
from .propagate import Count


@dataclass(frozen=True)
class LatticeKind:
    """What is in a lattice's cells, and how it scatters."""

    has_walls: bool
    """Whether surfaces stop and reflect light between the cells."""
    is_varied: bool
    """Whether the medium differs from cell to cell."""
    scheme: str = "deposit"
    """How a hop scatters in a homogeneous medium (settings.SCHEMES); "paper..." as eq. 3 has it."""
    is_straight: bool = True
    """Whether light keeps straighter on larger lattices (maths.lattice26.persistence)."""
    span: int = 0
    """Of its cells, how many light has around it along the longest side, beyond it, too; 0: as many
    as the lattice has."""


class Level:
    """One lattice of the stack. Of the finest, source, medium and walls are the solver's own."""

    def __init__(
        self, gpu: Gpu, count: Count, cell_m: float, kind: LatticeKind, *, is_finest: bool
    ) -> None:
        cells = count[0] * count[1] * count[2]
        light = CHANNELS * cells * 16
        self.count, self.cell, self.cells, self.is_finest = count, cell_m, cells, is_finest
        # States in turn; their track, and what a step makes of a correction.
        self.sum, self.spare, self.track, self.answer = (
            Buffer(gpu, f"{name} {count}", light) for name in ("sum", "spare", "track", "answer")
        )
        self.packs = new_packs(gpu, cells if kind.has_walls else 1)
        # Coarser levels own what the solver gives the finest: residual, medium, walls.
        varied = CHANNELS * cells if kind.is_varied and not is_finest else 2
        walls = cells if kind.has_walls and not is_finest else 1
        self.source = Buffer(gpu, f"residual {count}", 16 if is_finest else light)
        self.medium = Buffer(gpu, f"medium {count}", varied * 8)
        self.face_visibility = Buffer(gpu, f"face visibility {count}", walls * 8)
        self.reflectance = Buffer(gpu, f"reflectance {count}", walls * 4)

    @property
    def grid(self) -> Count:
        """Invocations for passes over cells and channels, the channels stacked along z."""
        return (*self.count[:2], CHANNELS * self.count[2])

    def other(self, current: Buffer) -> Buffer:
        """Whichever of `sum` and `spare` is not `current`."""
        return self.spare if current is self.sum else self.sum
