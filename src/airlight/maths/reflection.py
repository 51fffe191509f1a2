"""What a surface reflects: from a direction to another one, and over all directions together.

The surface is Lambert plus GGX (glTF 2.0, appendix B). Twins: `wgsl/surface_reflection.wgsl`, and
`wgsl/glow_share.wgsl`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64

# Alphas between which highlights take over from mirrored rays: of surfaces and media that glow.
GLOW_SHARP, GLOW_BLURRED, MEDIUM_BLURRED = 0.01, 0.16, 0.06
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


def fresnel(f0: ArrayLike, cosine: ArrayLike) -> F64:
    """Schlick's reflectance (n, 3) of a surface with `f0` (n, 3) at normal incidence."""
    normal, c = np.asarray(f0, dtype=np.float64), np.asarray(cosine, dtype=np.float64)
    grazing = np.clip(50.0 * normal.max(axis=-1, keepdims=True), 0.0, 1.0)
    return np.asarray(normal + (grazing - normal) * np.clip(1.0 - c, 0.0, 1.0)[..., None] ** 5)


def matt_reflection(
    diffuse: ArrayLike, f0: ArrayLike, to_light: ArrayLike, to_eye: ArrayLike
) -> F64:
    """f(l, v) (n, 3), sr^-1, of light that passes into the surface and comes out again.

    `diffuse` is the albedo (n, 3) below the coat, `f0` (n, 3) the coat's reflectance.
    """
    v = np.asarray(to_eye, dtype=np.float64)
    coat = fresnel(f0, np.sum(v * _half(to_light, v), axis=-1))
    return np.asarray((1.0 - coat) * np.asarray(diffuse) / np.pi)


def mirrored_reflection(
    f0: ArrayLike, alpha: ArrayLike, normal: ArrayLike, to_light: ArrayLike, to_eye: ArrayLike
) -> F64:
    """f(l, v) (n, 3), sr^-1, of the coat: GGX, masked and shadowed together (Heitz2014).

    `alpha` (n,) is the roughness squared; with `matt_reflection` it is the whole surface.
    """
    n, light, v = (np.asarray(x, dtype=np.float64) for x in (normal, to_light, to_eye))
    h, a2 = _half(light, v), np.asarray(alpha, dtype=np.float64) ** 2
    n_l, n_h, v_h = (
        np.clip(np.sum(p * q, axis=-1), 0.0, 1.0) for p, q in ((n, light), (n, h), (v, h))
    )
    n_v = np.maximum(np.sum(n * v, axis=-1), 1e-4)
    # How many microfacets face half way, and how much of them both directions see, over 4 n.l n.v.
    facing = a2 / (np.pi * (n_h**2 * (a2 - 1.0) + 1.0) ** 2)
    masked = n_v * np.sqrt(n_l**2 * (1.0 - a2) + a2) + n_l * np.sqrt(n_v**2 * (1.0 - a2) + a2)
    return np.asarray(fresnel(f0, v_h) * (facing * 0.5 / np.maximum(masked, 1e-6))[..., None])


def _half(to_light: ArrayLike, to_eye: ArrayLike) -> F64:
    h = np.asarray(to_light, dtype=np.float64) + np.asarray(to_eye, dtype=np.float64)
    return np.asarray(h / np.linalg.norm(h, axis=-1, keepdims=True))


def glow_share(alpha: ArrayLike) -> F64:
    """What of the light of things that glow a surface shows by mirrored rays, not by highlights."""
    return _sharp(alpha, GLOW_BLURRED)


def medium_glow_share(alpha: ArrayLike) -> F64:
    """The same of media that glow."""
    return _sharp(alpha, MEDIUM_BLURRED)


def _sharp(alpha: ArrayLike, blurred: float) -> F64:
    x = np.clip((np.asarray(alpha) - GLOW_SHARP) / (blurred - GLOW_SHARP), 0.0, 1.0)
    return np.asarray(1.0 - x * x * (3.0 - 2.0 * x))
