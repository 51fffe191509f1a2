"""Surfaces that light passes straight through: blended ones, and thin glass.

Source: glTF 2.0, section 3.9.4 (alpha coverage), and KHR_materials_transmission: a surface without
thickness mirrors by Fresnel's term, and of the rest a share passes, tinted by the base colour.
Twins of `wgsl/translucency.wgsl`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64


def passed_share(
    base: ArrayLike, coverage: ArrayLike, transmission: ArrayLike, mirrored: ArrayLike
) -> F64:
    """The share (n, 3) of light that passes.

    `base` (n, 3) is the base colour, linear; `coverage` (n,) the share of the surface that is
    there; `transmission` (n,), of what is there and does not mirror, the share that passes;
    `mirrored` (n,) the reflectance of the surface at the angle of the light.
    """
    # What is not there, and of the rest what is neither mirrored nor kept.
    colour = np.clip(np.asarray(base, np.float64), 0.0, 1.0)
    c, t, m = (np.asarray(x, np.float64)[..., None] for x in (coverage, transmission, mirrored))
    return np.asarray(1.0 - c + c * t * (1.0 - m) * colour)


def dielectric_fresnel(f0: ArrayLike, cosine: ArrayLike) -> F64:
    """The reflectance (n,) at an angle of a dielectric that mirrors `f0` head on (Schlick1994)."""
    f, c = np.asarray(f0, np.float64), np.asarray(cosine, np.float64)
    f90 = np.clip(50.0 * f, 0.0, 1.0)
    return np.asarray(f + (f90 - f) * np.clip(1.0 - c, 0.0, 1.0) ** 5)


def chance(texel: ArrayLike, plane: ArrayLike) -> F64:
    """A number from 0 to 1 for each texel (n, 2), spread evenly among neighbours.

    `plane` (n,) tells surfaces apart that lie one behind the other. Source: Jimenez2014,
    interleaved gradient noise.
    """
    # A gradient whose steps fill the numbers evenly, shifted from surface to surface.
    x, y = np.moveaxis(np.asarray(texel, np.float64), -1, 0)
    turned = 52.9829189 * np.mod(0.06711056 * x + 0.00583715 * y, 1.0)
    return np.asarray(np.mod(turned + np.mod(7.31 * np.asarray(plane), 1.0), 1.0))
