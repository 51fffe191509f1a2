"""From scene radiance to what a display shows: exposure, a tone curve, 8-bit sRGB.

Every curve maps linear Rec.709 to display-linear Rec.709 in [0, 1], black to black, and never
gets darker as grey gets brighter.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64
from .chunks import CHUNK, chunks
from .colour import luminance, srgb_encode
from .lut import Lut
from .sampling import r2_noise

MIDDLE_GREY = 0.18


def none(radiance: ArrayLike) -> F64:
    """Clamp to [0, 1]; (..., 3) to (..., 3)."""
    return np.clip(np.asarray(radiance, dtype=np.float64), 0.0, 1.0)


# The AgX base curve in log2 exposure: 16.5 stops with middle grey 10 stops above black, through
# (pivot, 1/2) with slope 2, a toe of power 3 and a shoulder of power 3.25.
AGX_STOPS_BELOW_GREY = 10.0
AGX_STOPS = 16.5
AGX_PIVOT = AGX_STOPS_BELOW_GREY / AGX_STOPS
AGX_SLOPE = 2.0
AGX_TOE_POWER = 3.0
AGX_SHOULDER_POWER = 3.25
# The inset desaturates by a fifth towards these weights, so that no primary stays alone.
AGX_INSET = 0.2
AGX_INSET_WEIGHTS: F64 = np.array([0.2120053547523427, 0.3921825078090138, 0.3958121374386435])


def agx_bend(power: float, reach: float) -> float:
    """The coefficient k with AGX_SLOPE reach (1 + k reach^power)^(-1/power) = 1/2."""
    return float(((2.0 * AGX_SLOPE * reach) ** power - 1.0) / reach**power)


AGX_TOE_BEND = agx_bend(AGX_TOE_POWER, AGX_PIVOT)
AGX_SHOULDER_BEND = agx_bend(AGX_SHOULDER_POWER, 1.0 - AGX_PIVOT)


def agx_curve(encoded: ArrayLike) -> F64:
    """AgX's sigmoid of log-encoded exposure in [0, 1], to display-encoded [0, 1].

    Source: Sobotka, AgX (github.com/sobotka/AgX, AgX.py: equation_full_curve).
    """
    # Two sigmoids that meet at the pivot, one for the toe and one for the shoulder.
    offset = np.asarray(encoded, dtype=np.float64) - AGX_PIVOT
    low = offset < 0.0
    power = np.where(low, AGX_TOE_POWER, AGX_SHOULDER_POWER)
    bend = np.where(low, AGX_TOE_BEND, AGX_SHOULDER_BEND)
    bent = (1.0 + bend * np.abs(offset) ** power) ** (-1.0 / power)
    return np.asarray(0.5 + AGX_SLOPE * offset * bent)


def agx(radiance: ArrayLike) -> F64:
    """AgX base look, (..., 3) exposed radiance to (..., 3) display-linear.

    Source: Sobotka, AgX; the inset matrix is (1 - AGX_INSET) I + AGX_INSET 1 w^T, so grey stays
    exactly grey and its inverse needs no matrix. The curve's output is 2.2-encoded.
    """
    # Colours are drawn together before the curve.
    c = np.maximum(np.asarray(radiance, dtype=np.float64), 0.0)
    inset = (1.0 - AGX_INSET) * c + AGX_INSET * (c @ AGX_INSET_WEIGHTS)[..., None]
    # Stops around middle grey are what the curve maps.
    with np.errstate(divide="ignore"):
        stops = np.log2(inset / MIDDLE_GREY)
    shown = agx_curve(np.clip((stops + AGX_STOPS_BELOW_GREY) / AGX_STOPS, 0.0, 1.0))
    # The inset is undone: only what the curve compressed has lost saturation.
    outset = (shown - AGX_INSET * (shown @ AGX_INSET_WEIGHTS)[..., None]) / (1.0 - AGX_INSET)
    return np.asarray(np.clip(outset, 0.0, 1.0) ** 2.2)


# sRGB -> AP1 with the RRT's saturation, and back with the ODT's (Hill).
ACES_INPUT: F64 = np.array(
    [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]]
)
ACES_OUTPUT: F64 = np.array(
    [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]]
)
# Lifts middle grey from ACES' cinema level (0.10) to 0.21, next to the other curves.
ACES_EXPOSURE = 1.0 / 0.6


def aces(radiance: ArrayLike) -> F64:
    """ACES RRT + sRGB ODT, fitted; (..., 3) exposed radiance to (..., 3) display-linear.

    Source: Hill2016, the ACES fit in Baking Lab (ACES.hlsl); the exposure as in three.js.
    """
    # Into the space of the fit, and out of it again.
    c = np.maximum(np.asarray(radiance, dtype=np.float64), 0.0) * ACES_EXPOSURE
    v = c @ ACES_INPUT.T
    # The fit tends to 1/0.983729; far above 1 it is computed as a limit, free of overflow.
    v = np.minimum(v, 1e6)
    fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    return np.clip(fitted @ ACES_OUTPUT.T, 0.0, 1.0)


NEUTRAL_F90 = 0.04
NEUTRAL_COMPRESSION_START = 0.8 - NEUTRAL_F90
NEUTRAL_DESATURATION = 0.15


def neutral(radiance: ArrayLike) -> F64:
    """Khronos PBR neutral, (..., 3) exposed radiance to (..., 3) display-linear.

    Keeps base colours as they are and compresses highlights only.
    Source: Khronos, ToneMapping/PBR_Neutral, specification.
    """
    c = np.maximum(np.asarray(radiance, dtype=np.float64), 0.0)
    # Less what a dielectric mirrors at normal incidence: base colours come out as they are.
    x = c.min(axis=-1, keepdims=True)
    toe = x - x * x / (4.0 * NEUTRAL_F90)
    c = c - np.where(x <= 2.0 * NEUTRAL_F90, toe, NEUTRAL_F90)
    # Peaks above the start go towards 1 along a hyperbola, and towards white as they do.
    peak = c.max(axis=-1, keepdims=True)
    room = 1.0 - NEUTRAL_COMPRESSION_START
    above = np.maximum(peak, NEUTRAL_COMPRESSION_START)
    shown = 1.0 - room * room / (above + room - NEUTRAL_COMPRESSION_START)
    keep = 1.0 / (NEUTRAL_DESATURATION * (above - shown) + 1.0)
    compressed = c * (shown / above) * keep + shown * (1.0 - keep)
    return np.clip(np.where(peak <= NEUTRAL_COMPRESSION_START, c, compressed), 0.0, 1.0)


# A curve's place in this table is its number in tone.wgsl.
TONE_CURVES: dict[str, Callable[[ArrayLike], F64]] = {
    "none": none,
    "agx": agx,
    "aces": aces,
    "neutral": neutral,
}


def tone_map(radiance: ArrayLike, exposure_stops: float, name: str) -> F64:
    """Display-linear (..., 3) in [0, 1] of linear radiance (..., 3) W m^-2 sr^-1.

    Radiance is scaled by 2**exposure_stops first; NaN and infinite values become 0.
    Raises ValueError for a curve that is not in TONE_CURVES.
    """
    if name not in TONE_CURVES:
        raise ValueError(f"tone curve '{name}' is unknown; known: {', '.join(TONE_CURVES)}")
    c = np.asarray(radiance, dtype=np.float64)
    return TONE_CURVES[name](np.where(np.isfinite(c), c, 0.0) * 2.0**exposure_stops)


DITHER_CODES = 0.98
"""Width of dithering in code values: below 1, so that rounding errors leave whole codes alone."""


def dither_codes(height_px: int, width_px: int) -> F64:
    """What (H, W) is added to code values before they are rounded, mean 0: r2_noise."""
    y, x = np.indices((height_px, width_px), dtype=np.uint32)
    return np.asarray(DITHER_CODES * (r2_noise(x, y) - 0.5))


def display_srgb8(
    radiance: ArrayLike,
    exposure_stops: float,
    tone_map: str,
    *,
    lut: Lut | None = None,
    dither: bool = False,
) -> NDArray[np.uint8]:
    """8-bit sRGB (H, W, 3) of linear radiance (H, W, 3) W m^-2 sr^-1.

    `tone_map` names the curve; `lut` is looked up after it, by encoded values.
    With `dither` a fixed pattern of at most half a code value hides the bands of smooth skies; the
    same for every image, and for all colours, so that grey stays grey. Non-finite pixels become 0.
    Raises ValueError for an unknown curve.
    """
    # One pattern of noise for all rows and colours.
    pixels = np.asarray(radiance)
    shown = np.empty(pixels.shape, np.uint8)
    noise = dither_codes(*pixels.shape[:2])[..., None] if dither else None
    # A few rows at a time, whose temporary arrays stay in the processor's cache.
    for rows in chunks(len(pixels), max(1, CHUNK // max(1, pixels.shape[1]))):
        encoded = srgb_encode(_mapped(pixels[rows], exposure_stops, tone_map))
        codes = 255.0 * (lut.applied(encoded) if lut else encoded)
        if noise is not None:
            codes += noise[rows]
        shown[rows] = np.clip(np.floor(codes + 0.5), 0.0, 255.0)
    return shown


_mapped = tone_map  # display_srgb8's parameter carries the name a caller writes


def auto_exposure(radiance: ArrayLike, key: float = MIDDLE_GREY) -> float:
    """Stops that bring the log-average luminance of radiance (..., 3) to `key`.

    Black and non-finite pixels are left out; the darkest 5% and the brightest 2% of the rest count
    as their percentiles: dark corners or a light source must not decide. A black image gets 0.
    Source: Reinhard2002, eq. 1, with percentile clipping.
    """
    # Only pixels with light say how bright the image is.
    y = luminance(radiance).ravel()
    y = y[np.isfinite(y) & (y > 0.0)]
    if y.size == 0:
        return 0.0

    # Both ends count as their percentiles in the mean of logarithms.
    low, high = np.percentile(y, [5.0, 98.0])
    inner = np.clip(y, low, high)
    return float(np.log2(key) - np.log2(inner).mean())
