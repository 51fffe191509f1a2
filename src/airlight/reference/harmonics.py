"""Real spherical harmonics of any number of bands, and directions that integrate them exactly.

Index l^2 + l + m. Unit directions (..., 3); z is the polar axis.
"""

from __future__ import annotations

import numpy as np

from ..scene.checks import F64


def harmonics(directions: F64, bands: int) -> F64:
    """The basis (..., bands^2) at unit directions, without the Condon-Shortley sign."""
    x, y, z = np.moveaxis(np.asarray(directions, dtype=np.float64), -1, 0)
    basis = np.zeros((bands * bands, *z.shape))
    # q_m^m sin^m and q_l^m sin^m: sine and cosine of the azimuth come with powers of (x, y).
    cos_m, sin_m = np.ones_like(z), np.zeros_like(z)
    top = np.full(z.shape, np.sqrt(0.25 / np.pi))
    for m in range(bands):
        if m:
            top = top * np.sqrt((2.0 * m + 1.0) / (2.0 * m))
            cos_m, sin_m = cos_m * x - sin_m * y, sin_m * x + cos_m * y
        # Up in degree at the same order, by the recurrence of normalised Legendre functions.
        before, here = np.zeros_like(z), top
        for order in range(m, bands):
            base = order * order + order
            if m == 0:
                basis[base] = here
            else:
                basis[base + m] = np.sqrt(2.0) * here * cos_m
                basis[base - m] = np.sqrt(2.0) * here * sin_m
            up = np.sqrt((4.0 * (order + 1) ** 2 - 1.0) / ((order + 1) ** 2 - m * m))
            down = np.sqrt((order**2 - m * m) / max(4.0 * order**2 - 1.0, 1.0)) if order else 0.0
            before, here = here, up * (z * here - down * before)
    return np.moveaxis(basis, 0, -1)


def band_of(bands: int) -> F64:
    """Band l of every coefficient (bands^2,)."""
    return np.repeat(np.arange(bands), 2 * np.arange(bands) + 1).astype(np.float64)


def quadrature_directions(bands: int) -> tuple[F64, F64]:
    """Directions (n, 3) and weights (n,), sr: exact for products of two functions of `bands`.

    Gauss-Legendre in the cosine, equal steps in azimuth.
    """
    # n cosines are exact to degree 2n - 1, 2n azimuths to order 2n - 1.
    cosine, weight = np.polynomial.legendre.leggauss(bands)
    phi = 2.0 * np.pi * (np.arange(2 * bands) + 0.5) / (2 * bands)
    sine = np.sqrt(1.0 - cosine**2)

    # z, the polar axis, carries the cosine; azimuth turns in the plane of x and y.
    directions = np.stack(
        [
            sine[:, None] * np.cos(phi),
            sine[:, None] * np.sin(phi),
            np.broadcast_to(cosine[:, None], (bands, 2 * bands)),
        ],
        axis=-1,
    )

    # Each row's weight over 2 bands azimuths: weights add up to 4 pi.
    weights = np.repeat(weight * (np.pi / bands), 2 * bands)
    return directions.reshape(-1, 3), weights


def window(bands: int) -> F64:
    """Hanning's window (bands^2,) over bands: takes the ringing out of a truncated series."""
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * band_of(bands) / bands))
