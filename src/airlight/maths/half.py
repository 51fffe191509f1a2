"""Half floats, as textures keep values."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

HALF_MAX = 65504.0
"""The largest half float."""


_BRIGHT = 1000.0
"""What the brightest of stored light becomes: the rest of the range is for what adds up."""


def half_scale(largest: float) -> float:
    """Stored units per unit of values up to `largest`, a power of two: none leaves half floats."""
    return float(2.0 ** math.floor(math.log2(_BRIGHT / max(largest, 1e-30))))


def half_floats(
    values: NDArray[Any], scale: float | None = None, *, out: NDArray[np.float16] | None = None
) -> NDArray[np.float16]:
    """`values`, times `scale` in double precision where it is given, as half floats (in `out`);
    what is larger than those becomes HALF_MAX.

    It goes slice by slice along the first axis: large grids and maps have no other copy.
    """
    # Row by row, in single slices of double precision.
    made = np.empty(values.shape, np.float16) if out is None else out
    for row, part in zip(made, values, strict=True):
        scaled = part if scale is None else part.astype(np.float64) * scale
        row[...] = np.minimum(scaled, HALF_MAX)
    return made
