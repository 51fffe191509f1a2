"""The sum of all states on a lattice, Q = I + M Q, and its track T Q.

`Schedule` says how many steps there are: a fixed number of dispatches, so that a frame never waits
for a residual to come back from the device.

    source I -> step -> ... -> step -> global power rescaling -> Q -> its track T Q
                  |              ^
             what is under way, by regions, as it will have become
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import pack_array
from ..gpu.memory import Buffer
from ..gpu.recorded import Recorded
from ..maths.lattice26 import persistence
from .coefficients import CHANNELS, StepCoefficients, handed_on, paper_rows, step_rows
from .hop_visibility import HopVisibility, new_packs
from .power_rescaling import PowerRescaling
from .propagate import Count, Operator, Step, StepMedium
from .regions import Regions
from .schedule import Schedule


@dataclass(frozen=True)
class LatticeKind:
    """What is in a lattice's cells, and how it scatters."""

    has_walls: bool
    """Whether surfaces stop and reflect light between the cells."""
    is_varied: bool
    """Whether the medium differs from cell to cell."""
    scheme: str = "deposit"
    """How a hop scatters in a homogeneous medium (settings.SCHEMES); "paper..." as eq. 3 has it."""
    is_clear: bool = False
    """Whether there is no medium anywhere (maths.lattice26.persistence)."""
    span: int = 0
    """Of its cells, how many light has around it along the longest side, beyond it, too; 0: as many
    as the lattice has."""


class StateSum:
    """Solves Q = I + M Q and hands on its track T Q."""

    def __init__(
        self, gpu: Gpu, count: Count, cell_size_m: float, schedule: Schedule, kind: LatticeKind
    ) -> None:
        """Of a lattice of `count` cells; another schedule is by regions only if this one is."""
        self.schedule, self.kind, self.count, self.cell = schedule, kind, count, cell_size_m
        cells = count[0] * count[1] * count[2]
        # Q in turn, its track, and a source without light.
        self._sum, self._spare, self.track, self._zero = (
            Buffer(gpu, name, CHANNELS * cells * 16)
            for name in ("sum", "spare", "track", "no light")
        )
        # What is in the cells: rows of coefficients, or a medium for each; visibility of hops.
        rows = 2 * CHANNELS * StepCoefficients.dtype.itemsize
        self._coefficients = Buffer(gpu, "step numbers", rows)
        self._varied = Buffer(gpu, "no medium", 16)
        self._packs = new_packs(gpu, cells if kind.has_walls else 1)
        self._face_visibility = Buffer(gpu, "no walls", 8)
        # Larger lattices keep light straighter, which hops would spread too soon.
        self._persistence = persistence(kind.span or max(count), is_clear=kind.is_clear)
        is_paper = kind.scheme != "deposit"
        self._step = Step(
            gpu,
            has_walls=kind.has_walls,
            is_varied=kind.is_varied,
            handed_on=handed_on(is_gamma_fixed=kind.scheme == "paper-gamma") if is_paper else 0.0,
        )
        if not schedule.is_empty:
            self._step.begin(count)
        self._visibility = HopVisibility(gpu) if kind.has_walls else None
        # What brings slow light along.
        self._rescaling, self._regions = PowerRescaling(gpu), None
        if schedule.by_regions:
            self._regions = Regions(gpu, count, has_walls=kind.has_walls, is_varied=kind.is_varied)
        self._is_parted = self._is_exchanged = False  # into regions; whose light is known
        self._recorded = Recorded(gpu, "steps of a lattice")

    def set_homogeneous(self, sigma_s: Sequence[float], sigma_t: Sequence[float]) -> None:
        """Take on a homogeneous medium, (3,) m^-1 each. Raises SettingsError (scheme paper)."""
        if self.kind.scheme == "deposit":
            rows = step_rows(sigma_s, sigma_t, self.cell, persistence=self._persistence)
        else:
            # As printed, with the paper's gamma or the one that hands on all light.
            fixed = self.kind.scheme == "paper-gamma"
            rows = paper_rows(sigma_s, sigma_t, self.cell, is_gamma_fixed=fixed)
        self._coefficients.write(pack_array(StepCoefficients, rows))
        self._is_exchanged = False

    def set_varied(self, medium: Buffer) -> None:
        """Take on a medium, (sigma_s, sigma_t) m^-1 per channel and cell."""
        if self.kind.scheme != "deposit":  # the rows of a vacuum: cells have their own gains
            self.set_homogeneous((0.0,) * CHANNELS, (0.0,) * CHANNELS)
        self._varied, self._is_exchanged = medium, False

    def set_walls(self, commands: Commands, face_visibility: Buffer, reflectance: Buffer) -> None:
        """Take on walls, as `lattice.blockers` has them; `reflectance` u32 rgb unorm8 per cell."""
        if self._visibility is None:
            return
        self._face_visibility = face_visibility
        self._is_parted = self._is_exchanged = False
        self._visibility.encode(commands, self.count, face_visibility, reflectance, self._packs)

    @property
    def medium(self) -> StepMedium:
        """What is in the cells."""
        return StepMedium(
            self.count, self.cell, self._varied, self._coefficients, self._packs, self._persistence
        )

    def encode(self, commands: Commands, source: Buffer) -> tuple[Buffer, Buffer]:
        """(sum, track) of all states, W and W m, from `source` (W per cell), itself the first."""
        self._prepare_regions(commands)
        # Recorded for a schedule and its buffers.
        key = (self.schedule, source, self._varied, self._face_visibility)
        return self._recorded.encode(commands, key, partial(self._solved, commands, source))

    def _prepare_regions(self, commands: Commands) -> None:
        """Part the cells where walls changed, and find what regions exchange where anything did."""
        if self._regions is None or self._is_exchanged:
            return
        if not self._is_parted:
            self._regions.take_walls(commands, self._face_visibility)
        self._regions.take_medium(commands, self.medium)
        self._is_parted = self._is_exchanged = True

    def _solved(self, commands: Commands, source: Buffer) -> tuple[Buffer, Buffer]:
        if self.schedule.is_empty:
            return source, self._zero
        # Steps, between which regions get what is under way to them.
        current = source
        for step in range(self.schedule.steps):
            stepped = self._stepped(commands, current, source)
            if self._regions and self.schedule.is_corrected(step):
                self._regions.correct(commands, current=current, stepped=stepped)
            current = stepped
        # What is still under way is a smooth global mode: the power that was lost says how much.
        if self.schedule.by_regions:
            stepped = self._stepped(commands, current, source)
            self._rescaling.encode(commands, self.count, source, current=current, stepped=stepped)
        # The track of the sum is what media and surfaces see.
        self._step.encode(
            commands,
            self.medium,
            Operator.TRACK,
            before=current,
            source=self._zero,
            after=self.track,
        )
        return current, self.track

    def _stepped(self, commands: Commands, current: Buffer, source: Buffer) -> Buffer:
        """I + M Q, from Q in `current`; returns where it is."""
        target = self._spare if current is self._sum else self._sum
        medium = self.medium
        self._step.encode(
            commands, medium, Operator.MOVE, before=current, source=source, after=target
        )
        return target
