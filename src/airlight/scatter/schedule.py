"""How many steps on which lattice: counted before the frame, never asked of the device.

none     the given number of iterations on the fine lattice
finish   those, then 8 at half and 16 at a quarter of the resolution for what is still under way
cycle    a W(1, 1) multigrid cycle for every 4 iterations, which is about what it costs: close to
         the converged field after two
regions  those, and after each third what later steps will bring to regions of the lattice at once
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import SettingsError, nearest
from ..maths.lattice26 import RHO, hops, mean_hop_length
from ..maths.medium import mean_absorption_depth

Count = tuple[int, int, int]
ACCELERATIONS = ("none", "finish", "cycle", "regions")
_SMALLEST = 4  # cells along the longest side of the coarsest lattice
_MOST = 512
_CYCLE_ITERATIONS = 4  # that a cycle costs about as much as
_CYCLE_LEAVES = 0.3  # of the light under way, in a dense medium; measured
_CORRECTED = 3  # steps for each correction by regions
_STEP_LEAVES = 0.86  # of the light under way, with these corrections, around two walls; measured


@dataclass(frozen=True)
class Schedule:
    """Steps `before` and `after` the correction by the next coarser level, per level.

    `visits` of the coarser level per correction (2 makes W cycles), `cycles` in all;
    `iterations` is what was asked for; `is_rescaled`: the sum's power is rescaled at last (see
    power_rescaling).
    """

    before: tuple[int, ...]
    after: tuple[int, ...]
    visits: int = 1
    cycles: int = 1
    iterations: int = 0
    is_empty: bool = False
    is_rescaled: bool = False
    region_steps: int = 0  # with corrections by regions between them

    @property
    def has_regions(self) -> bool:
        """Whether there are corrections by regions."""
        return self.region_steps > 0

    def is_corrected(self, step: int) -> bool:
        """Whether regions get what is under way after a step: the first, and each third."""
        return step == 0 or step % _CORRECTED == _CORRECTED - 1

    def counts(self, count: Count) -> list[Count]:
        """The cells of each level's lattice."""
        counts = [count]
        for _ in self.before[1:]:
            # A coarse cell stands for eight; at odd ends it reaches beyond them.
            x, y, z = counts[-1]
            counts.append((-(-x // 2), -(-y // 2), -(-z // 2)))
        return counts


def schedule(acceleration: str, iterations: int, count: Count) -> Schedule:
    """The plan for a lattice of `count` cells. Raises SettingsError for an unknown acceleration.

    With n iterations the light of the states 0 .. n - 1 is counted; of cycles there are n / 4.
    """
    if acceleration not in ACCELERATIONS:
        raise SettingsError(
            f"acceleration = '{acceleration}' is unknown",
            remedy=nearest(acceleration, ACCELERATIONS),
        )
    if iterations < 1:
        return Schedule((0,), (0,), is_empty=True)
    if acceleration == "regions":
        return Schedule(
            (0,),
            (0,),
            cycles=0,
            iterations=iterations,
            is_rescaled=True,
            region_steps=iterations,
        )
    # Levels are halved until the longest side has _SMALLEST cells.
    coarser = 0
    while max(count) / 2**coarser > _SMALLEST:
        coarser += 1
    if acceleration == "none" or coarser == 0:
        return Schedule((iterations - 1,), (0,), iterations=iterations)
    # The given lattice has all iterations; one or two coarser ones then finish what is under way.
    if acceleration == "finish":
        depth = min(coarser, 2)
        before, after = (iterations - 1, 8, 16)[: depth + 1], (1, 0, 0)[: depth + 1]
        return Schedule(before, after, iterations=iterations)
    # A W(1, 1) cycle, with eight steps on the coarsest lattice in place of a solution.
    ones = (1,) * coarser
    cycles = max(1, round(iterations / _CYCLE_ITERATIONS))
    return Schedule(
        (*ones, 8), (*ones, 0), visits=2, cycles=cycles, iterations=iterations, is_rescaled=True
    )


def region_steps_to(residual: float) -> int:
    """Iterations that leave about `residual` of the light under way, with regions."""
    return math.ceil(math.log(max(residual, 1e-6)) / math.log(_STEP_LEAVES)) + _CORRECTED


def cycles_to(residual: float) -> int:
    """Iterations whose cycles leave about `residual` of the light under way."""
    # Each cycle leaves the same share of what is under way.
    cycles = math.ceil(math.log(1.0 / max(residual, 1e-6)) / math.log(1.0 / _CYCLE_LEAVES))
    return _CYCLE_ITERATIONS * max(1, cycles)


def iterations_to(
    residual: float,
    sigma_s: Sequence[float],
    sigma_t: Sequence[float],
    cell_size_m: float,
    count: Count,
) -> int:
    """Iterations after which about `residual` of the light is still under way, without walls.

    The slowest mode of a random walk with absorption out of the box, by the channel that takes
    longest, after the light has crossed the lattice once. Between 1 and 512.
    """
    # The channel whose slowest mode decays least decides, once light is everywhere.
    crossing = max(count) / mean_hop_length()
    channels = zip(sigma_s, sigma_t, strict=True)
    rate = min(_decay(s, t, cell_size_m, count) for s, t in channels)
    needed = crossing + math.log(1.0 / max(residual, 1e-6)) / max(rate, 1e-9)
    return int(min(max(math.ceil(needed), 1), _MOST))


def _decay(sigma_s: float, sigma_t: float, cell_size_m: float, count: Count) -> float:
    """Per iteration, the share that is absorbed and escapes of the slowest mode."""
    table = hops()
    x = np.asarray(sigma_t * cell_size_m * table.lengths)
    # The power that a hop keeps: what passes, and of the rest what is scattered.
    passed = np.exp(-x)
    albedo = sigma_s / sigma_t if sigma_t > 0.0 else 0.0
    kept = float(table.weights @ (passed + albedo * (1.0 - passed)))
    # Mean squared length of a hop, cells: whole if passed on, and by the share deposited ahead if
    # scattered; what is passed on keeps rho^2 of its direction, so lengths add up in line.
    ahead = passed + (1.0 - passed) * mean_absorption_depth(x)
    moved = float(table.weights @ (ahead * table.lengths**2))
    in_line = RHO**2 * float(table.weights @ passed)
    moved *= (1.0 + in_line) / (1.0 - in_line)
    # The slowest mode of diffusion in a box with extrapolated borders.
    escape = moved / 6.0 * sum((math.pi / (n + 1.42)) ** 2 for n in count)
    # No light leaves faster than it crosses.
    return min(escape, 2.0 * mean_hop_length() / max(count)) - math.log(max(kept, 1e-12))
