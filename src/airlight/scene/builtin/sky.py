"""A clear sky without its sun disk."""

from __future__ import annotations

from typing import cast

import numpy as np

from ...maths.latlong import latlong_texel_directions
from ..checks import F32, F64, Vec3
from ..environment import Environment
from ..sun_sky import MAP_HEIGHT

_GRADATION = (-1.0, -0.32)
_SCATTER = (10.0, -3.0, 0.45)
"""CIE S 011 (ISO 15469:2004), sky type 12, clear: a, b and c, d, e."""

_GLOW = 7.0
_ZENITH = np.array([0.85, 1.55, 2.75])
_PALE = np.array([1.75, 1.85, 1.95])
_GROUND = np.array([1.35, 1.15, 0.90])


def clear_sky(sun_travel: Vec3, *, height_px: int = MAP_HEIGHT, scale: float = 1.0) -> Environment:
    """Radiance of a clear sky, W m^-2 sr^-1, its zenith 0.85/1.55/2.75, for a high sun.

    `sun_travel` is the direction in which sunlight travels. The map is 2 `height_px` wide;
    below the horizon lies pale ground. Luminance: CIE S 011, equations 1 to 4, its glow around
    the sun rolled off below seven times the zenith: the sun itself is a light, not an image.
    """
    towards = latlong_texel_directions(height_px, 2 * height_px)
    cos_zenith = towards[..., 1]
    # Luminance by CIE S 011, colour from deep blue at the zenith to pale near the horizon and the
    # sun.
    sun = -np.array(sun_travel) / np.linalg.norm(sun_travel)
    luminance = _cie_clear(cos_zenith, towards @ sun, float(sun[1]))
    whiteness = (1.0 - np.clip(cos_zenith, 0.0, 1.0)) ** 3 + 0.15 * np.clip(luminance - 1, 0, 3)
    blend = np.clip(whiteness, 0.0, 1.0)[..., None]
    hue = _ZENITH / _ZENITH.mean() * (1.0 - blend) + _PALE / _PALE.mean() * blend
    # The glow rolls off towards _GLOW, so that no texel competes with the sun.
    sky = _ZENITH.mean() * (_GLOW * -np.expm1(-luminance / _GLOW))[..., None] * hue
    is_above = (cos_zenith > 0.0)[..., None]
    pixels = scale * np.where(is_above, sky, _GROUND)
    return Environment(map=cast(F32, pixels.astype(np.float32)), source="clear sky", horizon=True)


def _cie_clear(cos_zenith: F64, cos_sun: F64, cos_sun_zenith: float) -> F64:
    """Luminance relative to the zenith's."""
    here = _gradation(cos_zenith) * _scatter(cos_sun)
    overhead = _gradation(np.ones(1)) * _scatter(np.full(1, cos_sun_zenith))
    return here / overhead


def _gradation(cos_zenith: F64) -> F64:
    a, b = _GRADATION
    return 1.0 + a * np.exp(b / np.maximum(cos_zenith, 0.01))


def _scatter(cos_sun: F64) -> F64:
    c, d, e = _SCATTER
    angle: F64 = np.arccos(np.clip(cos_sun, -1.0, 1.0))
    value: F64 = 1.0 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2.0)) + e * cos_sun**2
    return value
