"""Long thin parts of glowing surfaces as segments: pieces of bent tubes, of strips along edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..scene.checks import F64
from .pieces import Pieces
from .stretches import LONG, principal

_BEADS = 0.5
"""Below so much of a tube, a row of beads is no segment: light would come from the gaps."""


@dataclass(frozen=True, eq=False)
class Segment:
    """`middle` (3,), m; `half` (3,), m, from there to an end; `width`, m, half of it across.

    `tube`: how much of what it sends to all sides goes as a cylinder sends it, by the sine of the
    angle from its axis; the rest goes evenly, as from beads.
    """

    middle: F64
    half: F64
    width: float
    tube: float = 0.0


def long_part(found: Pieces) -> Segment | None:
    """The segment that pieces lie along, as long as even light of their variance; None if wide."""
    # The long part's axis and half length, and how far it spreads across.
    light = found.areas * found.radiance.sum(axis=1) + 1e-30 * found.areas
    middle, variances, axes = principal(found.corners, light)
    half = float(np.sqrt(3.0 * variances[2]))
    across = float(np.sqrt(variances[0] + variances[1]))
    if half <= LONG * across or half <= 0.0:
        return None
    # Of a bent part the variance across is that of the bend; its surface is no wider than this.
    width = min(across, float(found.areas.sum()) / (4.0 * half))
    # Normals of a tube stand across it, those of beads everywhere: their squares are a third then.
    ahead = float((light / light.sum()) @ (found.normals @ axes[:, 2]) ** 2)
    tube = min(max(1.0 - 3.0 * ahead, 0.0), 1.0)
    if tube < _BEADS:
        return None
    return Segment(middle, half * axes[:, 2], max(width, 1e-4 * half), tube)
