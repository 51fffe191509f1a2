"""How many steps: counted before the frame, never asked of the device.

none     the given number of iterations
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
ACCELERATIONS = ("none", "regions")
FORMER_ACCELERATIONS = {"finish": "regions", "cycle": "regions"}
"""Names of multigrid cycles that are gone, and what is done instead."""
_MOST = 512
_CORRECTED = 3  # steps for each correction by regions
_STEP_LEAVES = 0.86  # of the light under way, with these corrections, around two walls; measured


@dataclass(frozen=True)
class Schedule:
    """How many iterations there are, and whether regions get what is under way between them.

    With n iterations the light of the states 0 .. n - 1 is counted. By regions a step more is
    taken, and the sum's power is rescaled at last (see power_rescaling).
    """

    iterations: int
    by_regions: bool = False

    @property
    def is_empty(self) -> bool:
        """Whether nothing propagates."""
        return self.iterations < 1

    @property
    def steps(self) -> int:
        """Steps of the sum, which begins with the first state."""
        return self.iterations if self.by_regions else self.iterations - 1

    def is_corrected(self, step: int) -> bool:
        """Whether regions get what is under way after a step: the first, and each third."""
        return self.by_regions and (step == 0 or step % _CORRECTED == _CORRECTED - 1)


def schedule(acceleration: str, iterations: int) -> Schedule:
    """The plan for a lattice. Raises SettingsError for an unknown acceleration."""
    if acceleration not in ACCELERATIONS:
        raise SettingsError(
            f"acceleration = '{acceleration}' is unknown",
            remedy=nearest(acceleration, ACCELERATIONS),
        )
    return Schedule(iterations, by_regions=acceleration == "regions")


def region_steps_to(residual: float) -> int:
    """Iterations that leave about `residual` of the light under way, with regions."""
    return math.ceil(math.log(max(residual, 1e-6)) / math.log(_STEP_LEAVES)) + _CORRECTED


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
