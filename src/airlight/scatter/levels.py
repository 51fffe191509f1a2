"""The sum of all states on a lattice, hurried along by coarser ones.

Q = I + M Q is stepped; what is missing after that is solved for where hops are twice as long and
cells an eighth as many, and handed back as a correction (maths.lattice26_levels is the NumPy
truth). `Schedule` says how often: a fixed number of dispatches, so a frame never waits for a
residual to come back from the device.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import pack_array
from ..gpu.memory import Buffer
from ..gpu.recorded import Recorded
from ..maths.lattice26 import RHO, persistence
from ..maths.lattice26_levels import mean_track
from .balance import Balance
from .coefficients import CHANNELS, StepCoefficients, paper_rows, step_rows
from .correction import Correction
from .doubling import summed_states
from .hop_wgsl import constants
from .hop_wgsl import mean_track as mean_track_wgsl
from .level_passes import LevelParams, Prolong, Restrict, RestrictAir, RestrictFaces
from .propagate import MOVE, TRACK, Count, Step
from .propagate_varied import VariedStep
from .schedule import Schedule
from .small_levels import Part, SmallLevels, first_small
from .walls import Walls, new_packs


class Level:
    """One lattice of the stack and its buffers."""

    def __init__(
        self,
        gpu: Gpu,
        count: Count,
        cell_size_m: float,
        *,
        is_blocked: bool,
        is_varied: bool,
        is_coarse: bool,
        is_small: bool,
    ) -> None:
        """`is_small`: its light is SmallLevels'."""
        cells = count[0] * count[1] * count[2]
        nbytes = 16 if is_small else CHANNELS * cells * 16
        self.count, self.cell, self.cells = count, cell_size_m, cells
        self.sum, self.spare, self.track, self.answer = (
            Buffer(gpu, f"{name} {count}", nbytes) for name in ("sum", "spare", "track", "answer")
        )
        self.packs = new_packs(gpu, cells if is_blocked else 1)
        # Level 0's source, air and visibility are its owner's.
        self.source = Buffer(gpu, f"residual {count}", nbytes if is_coarse else 16)
        self.medium = Buffer(gpu, "air", CHANNELS * cells * 8 if is_coarse and is_varied else 16)
        walls = cells if is_coarse and is_blocked else 1
        self.face_visibility = Buffer(gpu, "face_visibility", walls * 8)
        self.reflectance = Buffer(gpu, "reflectance", walls * 4)


class Levels:
    """Solves Q = I + M Q and hands on its track T Q."""

    def __init__(
        self,
        gpu: Gpu,
        count: Count,
        cell_size_m: float,
        schedule: Schedule,
        *,
        is_blocked: bool,
        is_varied: bool,
        scheme: str = "deposit",
        is_straight: bool = True,
    ) -> None:
        self.schedule, self.scheme = schedule, scheme
        self.is_blocked, self.is_varied = is_blocked, is_varied
        counts = schedule.counts(count)
        small = None if is_varied else first_small(counts)
        self.levels = [
            Level(
                gpu,
                size,
                cell_size_m * 2**k,
                is_blocked=is_blocked,
                is_varied=is_varied,
                is_coarse=k > 0,
                is_small=small is not None and k >= small,
            )
            for k, size in enumerate(counts)
        ]
        self._kept = persistence(max(count)) if is_straight else RHO**2
        self._zero = Buffer(gpu, "no light", CHANNELS * self.levels[0].cells * 16)
        self._correction, self._balance = Correction(gpu), Balance(gpu)
        rows = 2 * CHANNELS * (len(self.levels) + 1)
        self._coefficients = Buffer(gpu, "step numbers", StepCoefficients.dtype.itemsize * rows)
        self._step = (
            VariedStep(gpu, is_blocked=is_blocked)
            if is_varied
            else Step(gpu, is_blocked=is_blocked)
        )
        self._walls = Walls(gpu) if is_blocked else None
        self._restrict, self._prolong = (
            Restrict(gpu),
            Prolong(gpu, generated=f"{constants()}\n{mean_track_wgsl()}"),
        )
        self._restrict_air = RestrictAir(gpu) if is_varied else None
        self._restrict_faces = RestrictFaces(gpu) if is_blocked else None
        self._ways = [(1.0, 1.0, 1.0) for _ in self.levels]
        self._recorded = Recorded(gpu, "cycles of a lattice")
        self._small = (
            SmallLevels(gpu, counts, schedule, small, is_blocked=is_blocked) if small else None
        )
        self._source, self._medium = self._zero, self.levels[0].medium
        self._face_visibility = self.levels[0].face_visibility

    def set_air(self, sigma_s: Sequence[float], sigma_t: Sequence[float]) -> None:
        """Take on a homogeneous medium, (3,) m^-1 each. Raises SettingsError (scheme paper)."""
        rows = []
        for k, level in enumerate(self.levels):
            if self.scheme == "deposit":
                rows += step_rows(sigma_s, sigma_t, level.cell, level=k, kept=self._kept)
            else:
                fixed = self.scheme == "paper-gamma"
                rows += paper_rows(sigma_s, sigma_t, level.cell, is_gamma_fixed=fixed)
        # The finest once more, for corrections, which have either sign.
        rows += step_rows(
            sigma_s, sigma_t, self.levels[0].cell, keeps_deficits=False, kept=self._kept
        )
        self._coefficients.write(pack_array(StepCoefficients, rows))
        self._ways = [tuple(mean_track(sigma_t, level.cell).tolist()) for level in self.levels]
        if self._small:
            self._small.set_air(self._ways)

    def set_medium(self, commands: Commands, medium: Buffer) -> None:
        """Take on varying air, (sigma_s, sigma_t) m^-1 per channel and cell, and its means."""
        self._medium = medium
        for k in range(1, len(self.levels)):
            assert self._restrict_air
            coarse = self.levels[k]
            self._restrict_air.dispatch(
                commands,
                (*coarse.count[:2], CHANNELS * coarse.count[2]),
                params=self._pair(k),
                medium=self._air(k - 1),
                coarse_medium=coarse.medium,
            )

    def set_walls(self, commands: Commands, face_visibility: Buffer, reflectance: Buffer) -> None:
        """Take on walls, as `lattice.blockers` has them; `reflectance` u32 rgb unorm8 per cell."""
        if self._walls is None or self._restrict_faces is None:
            return
        self._face_visibility, white = face_visibility, reflectance
        for k, level in enumerate(self.levels):
            if k:
                self._restrict_faces.dispatch(
                    commands,
                    level.count,
                    params=self._pair(k),
                    face_visibility=face_visibility,
                    reflectance=white,
                    coarse_face_visibility=level.face_visibility,
                    coarse_reflectance=level.reflectance,
                )
                face_visibility, white = level.face_visibility, level.reflectance
            self._walls.encode(commands, level.count, face_visibility, white, level.packs)
            if self._small and k >= self._small.first:
                self._small.set_walls(commands, k, level.packs, face_visibility)

    def encode(self, commands: Commands, source: Buffer) -> tuple[Buffer, Buffer]:
        """(sum, track) of all states, W and W m, from `source` (W per cell), itself the first."""
        self._source = source
        key = (source, self._medium, self._face_visibility, *self._ways)
        return self._recorded.encode(commands, key, lambda: self._solved(commands, source))

    def _solved(self, commands: Commands, source: Buffer) -> tuple[Buffer, Buffer]:
        level = self.levels[0]
        if self.schedule.is_empty:
            return source, self._zero
        current = source
        for _ in range(self.schedule.cycles):
            current = self._cycle(commands, 0, current)
        if self.schedule.is_balanced:
            current = self._balance.encode(
                commands,
                level.count,
                source=source,
                current=current,
                stepped=self._smoothed(commands, 0, current),
            )
        self._apply(commands, 0, TRACK, current, self._zero, level.track)
        return current, level.track

    def _cycle(self, commands: Commands, k: int, current: Buffer) -> Buffer:
        """Smooth, correct by the next level, smooth; returns where the sum now is."""
        plan = self.schedule
        if self._is_doubled(k, current):
            current = self._doubled(commands, plan.before[k] + 1)
        else:
            for _ in range(plan.before[k]):
                current = self._smoothed(commands, k, current)
        left = plan.after[k]
        if k + 1 < len(self.levels):
            current = self._corrected(commands, k, current)
            left -= 1  # which the correction takes with it
        for _ in range(left):
            current = self._smoothed(commands, k, current)
        return current

    def _is_doubled(self, k: int, current: Buffer) -> bool:
        """Where a step that adds nothing is cheaper: without walls, whose steps are not linear."""
        is_first = k == 0 and current is self._source
        step = self._step
        return is_first and isinstance(step, Step) and step.leaves_out_zeros(self.levels[k].count)

    def _doubled(self, commands: Commands, states: int) -> Buffer:
        level = self.levels[0]

        def step(before: Buffer, added: Buffer | None, after: Buffer, number: int) -> None:
            self._apply(commands, 0, MOVE, before, added or self._zero, after, steps=number)

        # The track and the answer are free until a correction.
        sums, spare = (level.sum, level.spare), (level.track, level.answer)
        at_once = self._step.at_once(level.count) if isinstance(self._step, Step) else 1
        return summed_states(states, self._source, sums, spare, step, at_once)

    def _corrected(self, commands: Commands, k: int, current: Buffer) -> Buffer:
        level, coarse = self.levels[k], self.levels[k + 1]
        stepped = self._other(k, current)
        self._apply(commands, k, MOVE, current, self._source_of(k), stepped)
        track = self._solved_coarser(commands, k + 1, stepped, current)
        # The track is free until the end.
        change = level.track
        nx, ny, nz = level.count
        self._prolong.dispatch(
            commands,
            (nx, ny, CHANNELS * nz),
            params=self._pair(k + 1),
            track=track,
            medium=self._air(k),
            face_visibility=self._face_visibility if k == 0 else level.face_visibility,
            sum=current,
            change=change,
        )
        self._apply(commands, k, MOVE, change, self._zero, level.answer, is_change=True)
        corrected = self._other(k, stepped)
        self._correction.encode(
            commands,
            level.count,
            coarse.count,
            current=current,
            stepped=stepped,
            change=change,
            answer=level.answer,
            corrected=corrected,
            is_finest=k == 0,
        )
        return corrected

    def _solved_coarser(
        self, commands: Commands, k: int, stepped: Buffer, current: Buffer
    ) -> Buffer | Part:
        """The track of what level k finds for the residual of the finer `current`."""
        coarse = self.levels[k]
        small = self._small if self._small and self._small.first == k else None
        nx, ny, nz = coarse.count
        self._restrict.dispatch(
            commands,
            (nx, ny, CHANNELS * nz),
            params=self._pair(k),
            stepped=stepped,
            sum=current,
            residual=small.source if small else coarse.source,
        )
        if small:
            small.encode(commands, self._coefficients)
            return small.track
        found = coarse.source
        for _ in range(self.schedule.visits):
            found = self._cycle(commands, k, found)
        self._apply(commands, k, TRACK, found, self._zero, coarse.track)
        return coarse.track

    def _smoothed(self, commands: Commands, k: int, current: Buffer) -> Buffer:
        target = self._other(k, current)
        self._apply(commands, k, MOVE, current, self._source_of(k), target)
        return target

    def _apply(
        self,
        commands: Commands,
        k: int,
        row: int,
        before: Buffer,
        source: Buffer,
        after: Buffer,
        *,
        is_change: bool = False,
        steps: int = 1,
    ) -> None:
        level = self.levels[k]
        keeps_deficits = k == 0 and not is_change
        buffers = {"before": before, "source": source, "after": after, "packs": level.packs}
        if isinstance(self._step, VariedStep):
            self._step.encode(
                commands,
                level.count,
                level.cell,
                self._air(k),
                is_track=row == TRACK,
                keeps_deficits=keeps_deficits,
                kept=self._kept,
                **buffers,
            )
        else:
            # The finest level's rows for corrections come last.
            first = 2 * CHANNELS * (len(self.levels) if is_change and k == 0 else k) + row
            self._step.encode(
                commands,
                level.count,
                self._coefficients,
                first,
                **buffers,
                is_added=source is not self._zero,
                steps=steps,
            )

    def _other(self, k: int, current: Buffer) -> Buffer:
        level = self.levels[k]
        return level.spare if current is level.sum else level.sum

    def _source_of(self, k: int) -> Buffer:
        return self.levels[k].source if k else self._source

    def _air(self, k: int) -> Buffer:
        return self.levels[k].medium if k else self._medium

    def _pair(self, k: int) -> LevelParams:
        """Parameters for level k and the finer one before it."""
        return LevelParams.of(
            fine=self.levels[k - 1].count,
            cell=self.levels[k - 1].cell,
            coarse=self.levels[k].count,
            way=self._ways[k - 1],
            flags=int(self.is_blocked) + 2 * int(self.is_varied),
        )
