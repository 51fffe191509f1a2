"""Light in the air that goes about one way, as media scatter it.

Of the light in a place its mean radiance and its mean direction are known. It counts as a lobe of
Henyey and Greenstein's about that direction (Henyey1941), with the mean cosine that it has.
Scattered by a function of mean cosine g, a lobe of mean cosine r becomes one of g r, since each of
their Legendre moments is a power of the first. So light that goes one way alone is scattered as
the phase function has it, light from all sides evenly, and neither is ever less than none, as two
bands of harmonics would have it.
Source: ours.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .colour import luminance
from .phase import ISOTROPIC, scattering_phase


def lobe_phase(light: ArrayLike, along: ArrayLike, travel: ArrayLike, g: ArrayLike) -> F64:
    """The phase function, over isotropic scattering, into rays that `travel` (..., 3) some way.

    Of light of the luminance `light` (...) and `along` (..., 3), that times its mean direction, in
    a medium of mean cosine `g` (..., 3).
    """
    flow, way = np.asarray(along, np.float64), np.asarray(travel, np.float64)
    flux = np.linalg.norm(flow, axis=-1)
    sharpness = np.minimum(flux / np.maximum(light, 1e-20), 1.0)
    cosine = (flow * way).sum(axis=-1) / np.maximum(flux, 1e-20)
    sharper = sharpness[..., None] * np.asarray(g, np.float64)
    return np.asarray(scattering_phase(cosine[..., None], sharper) / ISOTROPIC)


def scattered_lobe(mean: ArrayLike, along: ArrayLike, travel: ArrayLike, g: ArrayLike) -> F64:
    """(..., 3): what a medium scatters of light of a `mean` (..., 3) radiance into such rays.

    Radiance per length in the medium, times its scattering coefficient.
    """
    light = np.maximum(np.asarray(mean, np.float64), 0.0)
    return np.asarray(light * lobe_phase(luminance(light), along, travel, g))


def turned_lobe(flow: ArrayLike, travel: ArrayLike, given: ArrayLike, g: ArrayLike) -> F64:
    """The same into rays that `travel` one way over that into those that travel a `given` one.

    `flow` (..., 4): `along` and the luminance.
    """
    f = np.asarray(flow, np.float64)
    one, other = (lobe_phase(f[..., 3], f[..., :3], way, g) for way in (travel, given))
    return np.asarray(one / other)
