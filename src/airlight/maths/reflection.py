"""How much of the light from all around a surface reflects, over all directions together.

The surface is Lambert plus GGX (glTF 2.0, appendix B), as `wgsl/surface_reflection.wgsl` shades it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]

# The mean of (1 - l.h)^5 over two directions that are each distributed as their cosine:
# what Schlick's term takes from the diffuse part.
SCHLICK_MEAN = 0.003686
# Polynomials in the roughness, lowest order first, fitted to the quadrature of
# tests/maths/test_reflection.py: GGX's own reflectance under uniform light, the part that
# F0 scales and the part that F90 scales, within .002 and .0006.
GGX_F0: tuple[float, ...] = (0.952567, -0.047394, 0.713008, -2.701481, 1.491485)
GGX_F90: tuple[float, ...] = (0.047105, 0.040300, -0.411123, 0.545499, -0.219233)


def bihemispherical_albedo(
    base_color: ArrayLike, metallic: ArrayLike, roughness: ArrayLike, specular: ArrayLike
) -> F64:
    """Reflected over incident power (n, 3) of a surface that uniform light falls on.

    `base_color` is (n, 3), linear; `metallic`, `roughness` and `specular` are (n,), 0 to 1. An
    indirect bounce takes it in place of the base colour: a dielectric reflects less of the light
    diffusely by what its coat reflects, and GGX loses the light that microfacets scatter twice.
    """
    base = np.asarray(base_color, dtype=np.float64)
    m, r, s = (np.asarray(x, dtype=np.float64)[..., None] for x in (metallic, roughness, specular))
    # At normal incidence, and at grazing, where less than 2 % at normal incidence falls with it
    # (Lagarde2014).
    f0 = 0.04 * s * (1.0 - m) + base * m
    f90 = np.clip(50.0 * f0.max(axis=-1, keepdims=True), 0.0, 1.0)
    # The base reflects what the coat, in the mean over all directions, does not.
    lost = f0 + (f90 - f0) * SCHLICK_MEAN
    # GGX's albedos by roughness, without the light that microfacets scatter twice.
    mirrored = f0 * np.polynomial.polynomial.polyval(r, GGX_F0)
    mirrored = mirrored + f90 * np.polynomial.polynomial.polyval(r, GGX_F90)
    return np.asarray(base * (1.0 - m) * (1.0 - lost) + mirrored)


def grazing_albedo(
    base_color: ArrayLike, metallic: ArrayLike, roughness: ArrayLike, specular: ArrayLike
) -> F64:
    """The part (n,) of `bihemispherical_albedo` that F90 gives: light that grazes the surface.

    Arguments as there.
    """
    # Only what F90 scales, of the same two reflectances.
    base = np.asarray(base_color, dtype=np.float64)
    m, r, s = (np.asarray(x, dtype=np.float64) for x in (metallic, roughness, specular))
    f0 = 0.04 * s[..., None] * (1.0 - m[..., None]) + base * m[..., None]
    f90 = np.clip(50.0 * f0.max(axis=-1), 0.0, 1.0)
    return np.asarray(f90 * np.maximum(np.polynomial.polynomial.polyval(r, GGX_F90), 0.0))
