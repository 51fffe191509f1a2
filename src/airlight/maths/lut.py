"""Lookup tables of colours, as grading applications write them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import F64


@dataclass(frozen=True, eq=False)
class Lut:
    """A table of colours between `low` and `high`, (3,) each.

    `table` is (n, n, n, 3), by red, green and blue, or (n, 3), each channel by itself; n is at
    least 2. Colours are display values: after the tone curve, encoded as sRGB.
    """

    table: F64
    low: F64
    high: F64

    def applied(self, values: F64) -> F64:
        """Colours (..., 3) by the table, blended between its entries; held at its ends."""
        steps = len(self.table) - 1
        at = np.clip((values - self.low) / (self.high - self.low), 0.0, 1.0) * steps
        # A table of one dimension is a curve for each channel.
        if self.table.ndim == 2:
            return np.stack(
                [np.interp(at[..., c], np.arange(steps + 1), self.table[:, c]) for c in range(3)],
                axis=-1,
            )
        first = np.minimum(at.astype(np.int64), steps - 1)
        share = at - first
        # The eight corners of the cube around a colour, weighted by the volumes opposite to them.
        out = np.zeros_like(at)
        for corner in np.ndindex(2, 2, 2):
            weight = np.where(np.array(corner) == 1, share, 1.0 - share).prod(axis=-1)
            r, g, b = np.moveaxis(first + corner, -1, 0)
            out += weight[..., None] * self.table[r, g, b]
        return out
