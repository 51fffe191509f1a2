"""The bronze rod a drape hangs from."""

from __future__ import annotations

import numpy as np

from ..mesh import Geometry
from .patch import merged, moved, placed_at
from .profile import Points, arc, profile, revolved
from .solids import box


def curtain_rod(length_m: float, reach_m: float) -> Geometry:
    """A rod along x through the origin with knobs, held from `reach_m` behind it (-z)."""
    # A thin rod with a ball at each end, turned about its axis and laid along x.
    half = 0.5 * length_m
    shape: Points = [*arc((0.0, -half - 0.06), 0.045, -89.9, 50.0, 4), (0.02, -half)]
    shape += [(0.02, half), *arc((0.0, half + 0.06), 0.045, -50.0, 89.9, 4)]
    lying = np.eye(4)
    lying[:3, :3] = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    # Two arms hold it from behind.
    arm = box((-0.015, -0.02, -reach_m), (0.015, 0.02, 0.0))
    arms = [moved(arm, placed_at(side * (half - 0.05), 0.0, 0.0)) for side in (-1.0, 1.0)]
    return merged([moved(revolved(profile(shape), 12), lying), *arms])
