"""Occlusion by near surfaces in a slice of the hemisphere, and the light that they give back."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64


def visible_arc(horizon: ArrayLike, normal: ArrayLike) -> F64:
    """Cosine-weighted visibility of a slice from the eye's direction to a horizon.

    Both angles (...) in rad, signed, from the direction to the eye; the normal is the one
    projected on the slice. The two arcs of an open slice sum to cos(n) + n sin(n).
    Source: Jimenez2016 eq. 7 (one side of the slice).
    """
    h, n = np.asarray(horizon, np.float64), np.asarray(normal, np.float64)
    return np.asarray(0.25 * (np.cos(n) + 2.0 * h * np.sin(n) - np.cos(2.0 * h - n)))


def interreflected(visibility: ArrayLike, albedo: ArrayLike) -> F64:
    """Visibility (...) with what occluders of the same diffuse albedo (...) reflect.

    Never less than the visibility. Source: Jimenez2016 eq. 10, a fit to path-traced scenes.
    """
    v, rho = np.asarray(visibility, np.float64), np.asarray(albedo, np.float64)
    a = 2.0404 * rho - 0.3324
    b = -4.7951 * rho + 0.6417
    c = 2.7552 * rho + 0.6903
    return np.asarray(np.maximum(v, ((v * a + b) * v + c) * v))


def specular_visibility(visibility: ArrayLike, n_v: ArrayLike, roughness: ArrayLike) -> F64:
    """Visibility (...) of what a glossy surface mirrors; n_v is the cosine towards the eye.

    The ambient visibility where roughness is 1 and the eye is overhead, nearer to all or
    nothing where the surface is smooth. Source: Lagarde2014 section 4.10.2.
    """
    v, c, r = (np.asarray(x, np.float64) for x in (visibility, n_v, roughness))
    return np.asarray(np.clip((c + v) ** np.exp2(-16.0 * r - 1.0) - 1.0 + v, 0.0, 1.0))


def hidden_flux(state: ArrayLike, towards: ArrayLike, visibility: ArrayLike) -> F64:
    """Of accumulated two-band states (..., 4), what comes from where near surfaces are.

    `towards` (..., 3) is the mean direction to them times the cosine-weighted share of the
    hemisphere that they hide, 1 - visibility (...). Times pi / cell^2 it is irradiance, W m^-2, and
    where they hide all it is that of `lattice6.surface_irradiance` to first order.
    """
    # The constant term by how much is hidden, the linear one by where it is hidden.
    s, d = np.asarray(state, np.float64), np.asarray(towards, np.float64)
    hidden = 1.0 - np.asarray(visibility, np.float64)
    flux = s[..., 0] * hidden - np.einsum("...i,...i->...", s[..., 1:], d)
    return np.asarray(np.maximum(flux, 0.0))


def replaced(irradiance: ArrayLike, from_them: ArrayLike, own: ArrayLike) -> F64:
    """Irradiance (...), W m^-2, with the near surfaces' own light in the place of the lattice's.

    `from_them` (...), W m^-2, is what the lattice has coming from them; `own` (...) their radiance,
    W m^-2 sr^-1, times the share of the hemisphere that they fill.
    """
    e, known, light = (np.asarray(x, np.float64) for x in (irradiance, from_them, own))
    return np.asarray(np.maximum(e - known, 0.0) + np.pi * light)


HIDDEN_BITS = 12


def packed_hidden(depth: ArrayLike) -> F64:
    """How much of the hemisphere is hidden, 0 to 1: the last bits of a packed depth."""
    bits = np.asarray(depth, np.float32).view(np.uint32)
    largest = (1 << HIDDEN_BITS) - 1
    return np.asarray((bits & largest) / float(largest))
