"""Final gather: how far the light of the frames before stands for that of a moving frame.

Twin of `wgsl/gather_history.wgsl`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64

BESIDE = 1e-3
"""Weight of a gather point that does not lie beside the place, where no nearer one is alike."""
SURE = 0.5
"""A likeness from which on a point of the frame before counts as the same surface."""
DEVIATIONS = 2.0
"""Of a mean over neighbours: how far from it light of the frames before is believed."""
ALIKE = 0.02
"""Of that mean: by what light may differ without noise."""
CHANGING = 4.0
"""Frames before that count at most while light changes."""


def texel_share(away: ArrayLike) -> F64:
    """Weight (...) of a point of the frame before, `away` (..., 2) points from the place there.

    Bilinear, and a little of points further off.
    """
    # Bilinear, with a floor so that some point always counts.
    near = np.maximum(1.0 - np.abs(np.asarray(away, dtype=np.float64)), 0.0)
    return np.asarray(near[..., 0] * near[..., 1] + BESIDE)


def frames_kept(frames: ArrayLike, best: ArrayLike, most: float) -> F64:
    """For how many frames (...) what was found before counts: of `frames`, `most` at most.

    `best`, 0 to 1: the likeness of the most alike of the points that it comes from. Where k frames
    count, the new one has a share of 1 / (k + 1): the mean, until there are `most`.
    """
    sure = np.clip(np.asarray(best, dtype=np.float64) / SURE, 0.0, 1.0)
    return np.asarray(np.minimum(np.asarray(frames, dtype=np.float64) * sure, most))


def noise_reach(mean: ArrayLike, variance: ArrayLike) -> F64:
    """How far (...) noise has light from its `mean` over neighbours, whose `variance` is given."""
    m, v = (np.asarray(value, dtype=np.float64) for value in (mean, variance))
    return np.asarray(DEVIATIONS * np.sqrt(np.maximum(v, 0.0)) + ALIKE * m)


def frames_believed(
    frames: ArrayLike, before: ArrayLike, mean: ArrayLike, variance: ArrayLike
) -> F64:
    """For how many frames (...) light of those `before` counts while light changes.

    For `CHANGING` at most, and none where it is twice as far from the `mean` of this frame's at the
    points around as noise has it; `variance` of that mean.
    """
    b, m = (np.asarray(value, dtype=np.float64) for value in (before, mean))
    reach = noise_reach(m, variance)

    # Within reach of noise all frames count, at twice the reach none.
    off = np.maximum(np.abs(b - m) - reach, 0.0)
    sure = np.clip(1.0 - off / np.maximum(reach, 1e-30), 0.0, 1.0)
    return np.asarray(np.minimum(np.asarray(frames, dtype=np.float64), CHANGING) * sure)


def followed(before: ArrayLike, mean: ArrayLike, variance: ArrayLike) -> F64:
    """Light (...) of the frames `before`, as near to that of this frame as noise may have it.

    `mean` of this frame's light at the points around, and the `variance` of that mean.
    Source: Salvi2016 (variance clipping), here by the deviation of the mean.
    """
    b, m = (np.asarray(value, dtype=np.float64) for value in (before, mean))
    reach = noise_reach(m, variance)
    return np.asarray(np.clip(b, np.maximum(m - reach, 0.0), m + reach))
