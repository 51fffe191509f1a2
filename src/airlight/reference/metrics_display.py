"""How different two images look: PSNR, SSIM and FLIP on what a display would show.

All take linear radiance (H, W, 3), the reference first. PSNR, SSIM and FLIP see it exposed by
`stops`, clamped and sRGB-encoded: a tone curve would hide differences in the highlights.
"""

from __future__ import annotations

import math

import numpy as np

from ..maths.colour import luminance, srgb_encode
from ..scene.checks import F32, F64

# FLIP's ACES fit, (a x^2 + b x)/(d x^2 + e x + f), and the level it exposes for
# (Andersson2021).
ACES_FIT = (0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14)
ACES_LEVEL = 0.85
SSIM_SIGMA_PX, SSIM_RADIUS_PX = 1.5, 5


def displayed(radiance: F32, stops: float) -> F64:
    """sRGB-encoded in [0, 1], (H, W, 3)."""
    return srgb_encode(np.asarray(radiance, dtype=np.float64) * 2.0**stops)


def psnr_db(reference: F32, image: F32, stops: float) -> float:
    """Peak signal-to-noise ratio, dB, of displayed images with peak 1; inf for equal ones."""
    error = float(np.mean((displayed(reference, stops) - displayed(image, stops)) ** 2))
    return -10.0 * math.log10(error) if error > 0.0 else math.inf


def ssim(reference: F32, image: F32, stops: float) -> float:
    """Mean structural similarity of displayed luminance, in [-1, 1] (Wang2004, eq. 13).

    Gaussian window of 11 pixels, deviation 1.5, K = (.01, .03), borders left out. An image
    smaller than the window is one window of equal weights.
    """
    x, y = (luminance(displayed(a, stops)) for a in (reference, image))

    # Moments under the window: means, variances and the covariance of the two images.
    mx, my = _windowed(x), _windowed(y)
    vx, vy = _windowed(x * x) - mx * mx, _windowed(y * y) - my * my
    cov = _windowed(x * y) - mx * my

    # The product of luminance, contrast and structure, each held off a division by zero.
    c1, c2 = 0.01**2, 0.03**2
    likeness = (2 * mx * my + c1) * (2 * cov + c2)
    return float(np.mean(likeness / ((mx * mx + my * my + c1) * (vx + vy + c2))))


def _windowed(a: F64) -> F64:
    """Means of `a` (H, W) under SSIM's separable window, where it fits."""
    # Without room for one window, the whole image is it.
    if min(a.shape) <= 2 * SSIM_RADIUS_PX:
        return np.full((1, 1), a.mean())
    offset = np.arange(-SSIM_RADIUS_PX, SSIM_RADIUS_PX + 1)
    weight = np.exp(-0.5 * (offset / SSIM_SIGMA_PX) ** 2)
    weight /= weight.sum()
    for axis in (0, 1):
        windows = np.lib.stride_tricks.sliding_window_view(a, len(weight), axis=axis)
        a = np.asarray(windows @ weight)
    return a


def flip_map(reference: F32, image: F32, stops: float) -> F32:
    """FLIP's error map (H, W) in [0, 1] of displayed images (Andersson2020).

    67 pixels per degree. Raises ImportError without flip-evaluator.
    """
    import flip_evaluator

    shown = (displayed(a, stops).astype(np.float32) for a in (reference, image))
    error, _, _ = flip_evaluator.evaluate(*shown, "LDR", inputsRGB=True, applyMagma=False)
    return np.asarray(error, dtype=np.float32)[..., 0]


def hdr_flip_map(reference: F32, image: F32, exposures: tuple[float, float]) -> F32:
    """HDR-FLIP's error map (H, W) in [0, 1] over a range of exposures, stops.

    The range is given, never left to flip-evaluator: it ends the whole process when it is asked
    to expose for a black image. Raises ImportError without flip-evaluator.
    """
    import flip_evaluator

    # The worst error over as many exposures, ends included, as the range has stops
    # (Andersson2021, HDR-FLIP).
    start, stop = exposures
    parameters = {
        "startExposure": start,
        "stopExposure": stop,
        "numExposures": max(2, math.ceil(stop - start)),
    }
    linear = (np.maximum(np.asarray(a, dtype=np.float32), 0.0) for a in (reference, image))
    error, _, _ = flip_evaluator.evaluate(
        *linear, "HDR", inputsRGB=False, applyMagma=False, parameters=parameters
    )
    return np.asarray(error, dtype=np.float32)[..., 0]


def flip_exposures(reference: F32) -> tuple[float, float]:
    """HDR-FLIP's first and last exposure, stops: the brightest and the median pixel just lit.

    differs: black pixels do not count, and the brightest is the 99.9th percentile, so that a
    spark or a black background does not set the range.
    """
    y = luminance(reference).ravel()

    # Pixels without light have no exposure that would just show them.
    lit = y[y > 0.0]
    if lit.size == 0:
        return 0.0, 1.0

    # Solve the fit for the radiance that it maps to the level: the larger root of a quadratic.
    a, b, d, e, f = ACES_FIT
    A, B, C = a - ACES_LEVEL * d, b - ACES_LEVEL * e, -ACES_LEVEL * f
    level = (-B + math.sqrt(B * B - 4.0 * A * C)) / (2.0 * A)
    bright, median = np.percentile(lit, [99.9, 50.0])
    start = math.log2(level / float(bright))
    return start, max(math.log2(level / float(median)), start + 1.0)
