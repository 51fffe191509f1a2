"""The sum of all states on a lattice, accelerated by regions or by coarser lattices.

Q = I + M Q is stepped; what is under way is brought between regions of the lattice at once
(`regions`). Or the residual that is left is solved for on a lattice whose hops are twice as long
and whose cells are an eighth as many, and handed back as a correction (geometric multigrid;
maths.lattice26_levels is the NumPy twin). `Schedule` says how often: a fixed number of dispatches,
so that a frame never waits for a residual to come back from the device.

    source I -> step -> ... -> step --residual--> coarser level, likewise
                                 ^                       |
                    line search +--- prolonged track <---+
    after the last cycle: global power rescaling -> Q, and its track T Q
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import pack_array
from ..gpu.memory import Buffer
from ..gpu.recorded import Recorded
from ..maths.lattice26 import RHO, persistence
from ..maths.lattice26_levels import mean_track
from .coefficients import CHANNELS, StepCoefficients, handed_on, paper_rows, step_rows
from .hop_visibility import HopVisibility
from .level import LatticeKind, Level
from .level_passes import LevelParams, Prolong, Restrict, RestrictFaces, RestrictMedium
from .line_search import LineSearch
from .power_rescaling import PowerRescaling
from .propagate import Count, Operator, Step, StepMedium
from .regions import Regions
from .schedule import Schedule


class Levels:
    """Solves Q = I + M Q and hands on its track T Q."""

    def __init__(
        self, gpu: Gpu, count: Count, cell_size_m: float, schedule: Schedule, kind: LatticeKind
    ) -> None:
        """A lattice of `count` cells, and the coarser ones that `schedule` asks for."""
        self.schedule, self.kind = schedule, kind  # another schedule has as many levels
        # From level to level cells are twice as long.
        self.levels = [
            Level(gpu, size, cell_size_m * 2**k, kind, is_finest=k == 0)
            for k, size in enumerate(schedule.counts(count))
        ]
        # Larger lattices keep light straighter, which hops would spread too soon.
        self._persistence = persistence(kind.span or max(count)) if kind.is_straight else RHO**2
        # What all levels share: a source without light, rows of coefficients, passes.
        self._zero = Buffer(gpu, "no light", CHANNELS * self.levels[0].cells * 16)
        rows = 2 * CHANNELS * len(self.levels)
        self._coefficients = Buffer(gpu, "step numbers", StepCoefficients.dtype.itemsize * rows)
        self._tracks = [(1.0, 1.0, 1.0) for _ in self.levels]
        is_paper = kind.scheme != "deposit"
        self._step = Step(
            gpu,
            has_walls=kind.has_walls,
            is_varied=kind.is_varied,
            handed_on=handed_on(is_gamma_fixed=kind.scheme == "paper-gamma") if is_paper else 0.0,
        )
        if not schedule.is_empty:
            self._step.begin(count)
        # What coarser levels are made by, and how corrections are sized.
        self._visibility = HopVisibility(gpu) if kind.has_walls else None
        self._restrict, self._prolong = Restrict(gpu), Prolong(gpu)
        self._restrict_medium = RestrictMedium(gpu) if kind.is_varied else None
        self._restrict_faces = RestrictFaces(gpu) if kind.has_walls else None
        self._line_search, self._rescaling = LineSearch(gpu), PowerRescaling(gpu)
        self._regions: Regions | None = None
        if schedule.has_regions:
            self._regions = Regions(gpu, count, has_walls=kind.has_walls, is_varied=kind.is_varied)
        self._is_parted = self._is_exchanged = False  # into regions; whose light is known
        self._recorded = Recorded(gpu, "cycles of a lattice")

    def set_homogeneous(self, sigma_s: Sequence[float], sigma_t: Sequence[float]) -> None:
        """Take on a homogeneous medium, (3,) m^-1 each. Raises SettingsError (scheme paper)."""
        # The numbers of a hop differ with its length, and so from level to level.
        rows = []
        for k, level in enumerate(self.levels):
            if self.kind.scheme == "deposit":
                rows += step_rows(
                    sigma_s, sigma_t, level.cell, level=k, persistence=self._persistence
                )
            else:
                # As printed, with the paper's gamma or the one that hands on all light.
                fixed = self.kind.scheme == "paper-gamma"
                rows += paper_rows(sigma_s, sigma_t, level.cell, is_gamma_fixed=fixed)
        self._coefficients.write(pack_array(StepCoefficients, rows))
        self._tracks = [tuple(mean_track(sigma_t, level.cell).tolist()) for level in self.levels]
        self._is_exchanged = False

    def set_varied(self, commands: Commands, medium: Buffer) -> None:
        """Take on a medium, (sigma_s, sigma_t) m^-1 per channel and cell, and its coarser means."""
        if self.kind.scheme != "deposit":  # the rows of a vacuum: cells have their own gains
            self.set_homogeneous((0.0,) * CHANNELS, (0.0,) * CHANNELS)
        self.levels[0].medium = medium
        self._is_exchanged = False
        # Coarser levels scatter as the means of the cells that they stand for.
        for k in range(1, len(self.levels)):
            assert self._restrict_medium
            self._restrict_medium.dispatch(
                commands,
                self.levels[k].grid,
                params=self._pair(k),
                medium=self.levels[k - 1].medium,
                coarse_medium=self.levels[k].medium,
            )

    def set_walls(self, commands: Commands, face_visibility: Buffer, reflectance: Buffer) -> None:
        """Take on walls, as `lattice.blockers` has them; `reflectance` u32 rgb unorm8 per cell."""
        if self._visibility is None or self._restrict_faces is None:
            return
        self.levels[0].face_visibility, self.levels[0].reflectance = face_visibility, reflectance
        self._is_parted = self._is_exchanged = False
        # Coarse faces and colours are means of finer ones; the visibility of hops follows.
        for k, level in enumerate(self.levels):
            if k:
                finer = self.levels[k - 1]
                self._restrict_faces.dispatch(
                    commands,
                    level.count,
                    params=self._pair(k),
                    face_visibility=finer.face_visibility,
                    reflectance=finer.reflectance,
                    coarse_face_visibility=level.face_visibility,
                    coarse_reflectance=level.reflectance,
                )
            self._visibility.encode(
                commands, level.count, level.face_visibility, level.reflectance, level.packs
            )

    @property
    def medium(self) -> StepMedium:
        """What is in the cells of the finest level."""
        return self._medium(0)

    def encode(self, commands: Commands, source: Buffer) -> tuple[Buffer, Buffer]:
        """(sum, track) of all states, W and W m, from `source` (W per cell), itself the first."""
        finest = self.levels[0]
        finest.source = source
        self._prepare_regions(commands)
        # Recorded for a schedule, its buffers and the numbers that its parameters hold.
        key = (self.schedule, source, finest.medium, finest.face_visibility, *self._tracks)
        return self._recorded.encode(commands, key, partial(self._solved, commands))

    def _prepare_regions(self, commands: Commands) -> None:
        """Part the cells where walls changed, and find what regions exchange where anything did."""
        level = self.levels[0]
        if self._regions is None or self._is_exchanged:
            return
        if not self._is_parted:
            self._regions.take_walls(commands, level.count, level.face_visibility)
        self._regions.take_medium(commands, self._medium(0))
        self._is_parted = self._is_exchanged = True

    def _solved(self, commands: Commands) -> tuple[Buffer, Buffer]:
        level = self.levels[0]
        if self.schedule.is_empty:
            return level.source, self._zero
        # Cycles bring the sum close to what endless iteration would find.
        current = level.source
        for _ in range(self.schedule.cycles):
            current = self._cycle(commands, 0, current)
        # Or steps do, with corrections by regions between them.
        for step in range(self.schedule.region_steps):
            current = self._stepped_by_regions(commands, step, current)
        # What is still under way is a smooth global mode: the power that was lost says how much.
        if self.schedule.is_rescaled:
            stepped = self._smoothed(commands, 0, current)
            self._rescaling.encode(commands, level, current=current, stepped=stepped)
        # The track of the sum is what media and surfaces see.
        medium = self._medium(0)
        self._step.encode(
            commands, medium, Operator.TRACK, before=current, source=self._zero, after=level.track
        )
        return current, level.track

    def _stepped_by_regions(self, commands: Commands, step: int, current: Buffer) -> Buffer:
        """Step `step` of Q in `current`, corrected where it is due; returns where it is."""
        level = self.levels[0]
        stepped = self._smoothed(commands, 0, current)
        if self._regions and self.schedule.is_corrected(step):
            self._regions.correct(commands, level.count, current=current, stepped=stepped)
        return stepped

    def _cycle(self, commands: Commands, k: int, current: Buffer) -> Buffer:
        """Smooth, correct by the next level, smooth; returns where the sum is."""
        plan = self.schedule
        # Smoothing leaves a residual that a coarser lattice can hold.
        for _ in range(plan.before[k]):
            current = self._smoothed(commands, k, current)
        # The coarser level finds what it would take many steps here to find.
        left = plan.after[k]
        if k + 1 < len(self.levels):
            current = self._corrected(commands, k, current)
            left -= 1  # which the correction takes with it
        # What the correction is too coarse for, neighbours even out.
        for _ in range(left):
            current = self._smoothed(commands, k, current)
        return current

    def _smoothed(self, commands: Commands, k: int, current: Buffer) -> Buffer:
        """I + M Q of level k, from Q in `current`; returns where it is."""
        level = self.levels[k]
        target = level.other(current)
        operator = Operator.MOVE if level.is_finest else Operator.CHANGE
        medium = self._medium(k)
        self._step.encode(
            commands, medium, operator, before=current, source=level.source, after=target
        )
        return target

    def _corrected(self, commands: Commands, k: int, current: Buffer) -> Buffer:
        """Q of level k, corrected by the next coarser level and stepped; returns where it is."""
        level, coarse = self.levels[k], self.levels[k + 1]
        # The residual, I + M Q - Q, is the source of the coarser level.
        stepped = self._smoothed(commands, k, current)
        pair = self._pair(k + 1)
        self._restrict.dispatch(
            commands, coarse.grid, params=pair, stepped=stepped, sum=current, residual=coarse.source
        )
        # The coarser level solves for it, from the residual itself on.
        found = coarse.source
        for _ in range(self.schedule.visits):
            found = self._cycle(commands, k + 1, found)
        # Its track is handed to the finer cells as states; the finer track is free until the end.
        track, medium = Operator.CHANGE_TRACK, self._medium(k + 1)
        self._step.encode(
            commands, medium, track, before=found, source=self._zero, after=coarse.track
        )
        self._prolong.dispatch(
            commands,
            level.grid,
            params=pair,
            track=coarse.track,
            medium=level.medium,
            face_visibility=level.face_visibility,
            sum=current,
            change=level.track,
        )
        # As much of the correction as leaves the least residual, taken one step on.
        change, medium = Operator.CHANGE, self._medium(k)
        self._step.encode(
            commands, medium, change, before=level.track, source=self._zero, after=level.answer
        )
        corrected = level.other(stepped)
        self._line_search.encode(
            commands, level, coarse, current=current, stepped=stepped, corrected=corrected
        )
        return corrected

    def _medium(self, k: int) -> StepMedium:
        """What is in the cells of level k."""
        level = self.levels[k]
        return StepMedium(
            level.count,
            level.cell,
            level.medium,
            self._coefficients,
            2 * CHANNELS * k,
            level.packs,
            self._persistence,
        )

    def _pair(self, k: int) -> LevelParams:
        """Parameters for level k and the finer one before it."""
        return LevelParams.of(
            fine=self.levels[k - 1].count,
            cell=self.levels[k - 1].cell,
            coarse=self.levels[k].count,
            track=self._tracks[k - 1],
            flags=int(self.kind.has_walls) + 2 * int(self.kind.is_varied),
        )
