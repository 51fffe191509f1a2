"""Whether invocations are lanes of one vector that can exchange values.

CPU adapters run eight invocations as lanes of a vector and make each lane's loads one by one, while
a value that the neighbouring lane has loaded costs a shuffle, a sixth of a load. Kernels that rely
on the order of lanes (eight in a row along x) ask here first.
"""

from __future__ import annotations

import numpy as np

from .commands import Commands
from .compute import ComputePass
from .device import Gpu
from .memory import Buffer
from .slots import storage

LANES = 8
_FEATURES = ("subgroup", "shader-int64")


class _Probe(ComputePass):
    """Each invocation writes its neighbours' numbers."""

    slots = (storage("found", "vec2u", "read_write"),)
    workgroup = (LANES, 1, 1)
    file = "lanes.wgsl"


def has_row_lanes(gpu: Gpu) -> bool:
    """Whether LANES invocations along x are one subgroup in that order, and 64-bit integers work.

    Only CPU adapters are asked: a GPU's threads are served by its caches.
    """
    # Facts of a device are tried once for all of its scopes.
    if not gpu.paths.row_lanes or any(name not in gpu.features for name in _FEATURES):
        return False
    if "row lanes" not in gpu.facts:
        gpu.facts["row lanes"] = _found_row_lanes(gpu)
    return gpu.facts["row lanes"]


def _found_row_lanes(gpu: Gpu) -> bool:
    """Run the probe: whether invocations find their neighbours' numbers beside them."""
    # Two subgroups, so that both of their ends are seen.
    groups = 2
    found = Buffer(gpu, "lanes", groups * LANES * 8)
    commands = Commands(gpu)
    _Probe(gpu).dispatch(commands, (groups * LANES, 1, 1), found=found)
    commands.submit()
    numbers = found.read(np.uint32).reshape(groups, LANES, 2)
    found.release()
    # Both directions are asked for: a driver that runs lanes in another order fails one of them.
    own = np.arange(groups * LANES).reshape(groups, LANES)
    is_before = np.array_equal(numbers[:, 1:, 0], own[:, :-1])
    return is_before and np.array_equal(numbers[:, :-1, 1], own[:, 1:])
