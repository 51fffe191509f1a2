"""Whether invocations run in lanes of one vector that may look at one another's values.

CPU adapters run eight invocations as lanes of a vector and make each lane's loads one by one,
while what the lane beside it has loaded costs a shuffle, a sixth of a load. Kernels that rely on
the order of lanes (eight in a row along x) ask here first.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .commands import Commands
from .compute import ComputePass
from .device import Gpu
from .memory import Buffer
from .slots import storage

LANES = 8
_WIDTHS = (4, 8)
_FEATURES = ("subgroup", "shader-int64")


class Rows(NamedTuple):
    """Columns along x and y that an invocation takes, and what it has to ask for."""

    width: int
    height: int
    is_whole: bool
    """A row's lanes hold all of it: nothing beside them is loaded."""
    is_ragged: bool
    """The last lane has fewer columns than `width`."""

    @classmethod
    def of(cls, row: int, height: int) -> Rows:
        """For a row of so many cells, an even number: the narrowest tile whose lanes hold it."""
        width = next((w for w in _WIDTHS if row <= LANES * w), _WIDTHS[0])
        return cls(width, height, row <= LANES * width, row % width != 0)


class _Probe(ComputePass):
    """Each invocation writes its neighbours' numbers."""

    slots = (storage("found", "vec2u", "read_write"),)
    workgroup = (LANES, 1, 1)
    file = "lanes.wgsl"


def has_row_lanes(gpu: Gpu) -> bool:
    """Whether LANES invocations along x are one subgroup in that order, and 64-bit integers work.

    Only CPU adapters are asked: a GPU's threads are served by its caches.
    """
    if not gpu.takes_cpu_paths or any(name not in gpu.features for name in _FEATURES):
        return False
    if "row lanes" not in gpu.facts:
        gpu.facts["row lanes"] = _found_row_lanes(gpu)
    return gpu.facts["row lanes"]


def _found_row_lanes(gpu: Gpu) -> bool:
    """Whether invocations find their neighbours' numbers where they are looked for."""
    groups = 2
    found = Buffer(gpu, "lanes", groups * LANES * 8)
    commands = Commands(gpu)
    _Probe(gpu).dispatch(commands, (groups * LANES, 1, 1), found=found)
    commands.submit()
    numbers = found.read(np.uint32).reshape(groups, LANES, 2)
    found.release()
    own = np.arange(groups * LANES).reshape(groups, LANES)
    is_before = np.array_equal(numbers[:, 1:, 0], own[:, :-1])
    return is_before and np.array_equal(numbers[:, :-1, 1], own[:, 1:])
