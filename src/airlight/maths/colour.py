"""Linear Rec.709 and its sRGB encoding."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F32, F64

# Relative luminance of the Rec.709 primaries with white D65, ITU-R BT.709-6.
REC709_LUMINANCE: F64 = np.array([0.2126, 0.7152, 0.0722])


def srgb_encode(linear: ArrayLike) -> F64:
    """Encoded value in [0, 1] of a linear one, any shape; clamped to [0, 1] first.

    Source: IEC 61966-2-1, piecewise.
    """
    x = np.clip(np.asarray(linear, dtype=np.float64), 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1.0 / 2.4) - 0.055)


def srgb_decode(encoded: ArrayLike) -> F64:
    """Linear value in [0, 1] of an encoded one, any shape; clamped to [0, 1] first.

    Source: IEC 61966-2-1, piecewise.
    """
    x = np.clip(np.asarray(encoded, dtype=np.float64), 0.0, 1.0)
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def in_rgb(grid: F32) -> F32:
    """(z, y, x, 3) of a grid of one channel, which stands for three; itself where it has three."""
    return np.ascontiguousarray(grid if grid.ndim == 4 else np.repeat(grid[..., None], 3, axis=-1))


def luminance(rgb: ArrayLike) -> F64:
    """Relative luminance (...) of linear Rec.709 (..., 3), in the unit of its input."""
    c = np.asarray(rgb, dtype=np.float64)
    return np.asarray(c @ REC709_LUMINANCE)
