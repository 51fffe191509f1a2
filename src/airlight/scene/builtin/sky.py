"""A clear sky without its sun disk."""

from __future__ import annotations

from typing import cast

import numpy as np

from ..checks import F32, F64, Vec3
from ..environment import Environment

_GRADATION = (-1.0, -0.32)
_SCATTER = (10.0, -3.0, 0.45)
"""CIE S 011 (ISO 15469:2004), sky type 12, clear: a, b and c, d, e."""

_ZENITH = np.array([0.85, 1.55, 2.75])
_PALE = np.array([1.75, 1.85, 1.95])
_GROUND = np.array([1.35, 1.15, 0.90])


def clear_sky(sun_travel: Vec3, *, height_px: int = 64, scale: float = 1.0) -> Environment:
    """Radiance of a clear sky, W m^-2 sr^-1, its zenith 0.85/1.55/2.75, for a high sun.

    `sun_travel` is the direction in which sunlight travels. The map is 2 `height_px` wide;
    below the horizon lies pale ground. Luminance: CIE S 011, equations 1 to 4, its glow around
    the sun cut at six times the zenith, where the sun itself takes over.
    """
    v = (np.arange(height_px) + 0.5) / height_px * np.pi
    u = (np.arange(2 * height_px) + 0.5) / (2 * height_px) * 2.0 * np.pi
    cos_zenith = np.cos(v)[:, None] * np.ones_like(u)
    towards = np.stack(
        [np.sin(v)[:, None] * np.sin(u), cos_zenith, -np.sin(v)[:, None] * np.cos(u)], axis=-1
    )
    sun = -np.array(sun_travel) / np.linalg.norm(sun_travel)
    luminance = _cie_clear(cos_zenith, towards @ sun, float(sun[1]))
    whiteness = (1.0 - np.clip(cos_zenith, 0.0, 1.0)) ** 3 + 0.15 * np.clip(luminance - 1, 0, 3)
    blend = np.clip(whiteness, 0.0, 1.0)[..., None]
    hue = _ZENITH / _ZENITH.mean() * (1.0 - blend) + _PALE / _PALE.mean() * blend
    sky = _ZENITH.mean() * np.minimum(luminance, 6.0)[..., None] * hue
    above = np.clip(0.5 + cos_zenith[..., None] * height_px / np.pi, 0.0, 1.0)
    pixels = scale * (above * sky + (1.0 - above) * _GROUND)
    return Environment(map=cast(F32, pixels.astype(np.float32)), source="clear sky")


def _cie_clear(cos_zenith: F64, cos_sun: F64, cos_sun_zenith: float) -> F64:
    a, b = _GRADATION
    c, d, e = _SCATTER

    def gradation(cosine: F64) -> F64:
        return cast(F64, 1.0 + a * np.exp(b / np.maximum(cosine, 0.01)))

    def scatter(cosine: F64) -> F64:
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        return 1.0 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2.0)) + e * cosine**2

    zenith = gradation(np.array(1.0)) * scatter(np.array(cos_sun_zenith))
    return gradation(cos_zenith) * scatter(cos_sun) / zenith
