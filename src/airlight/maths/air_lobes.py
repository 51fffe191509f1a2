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

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .phase import ISOTROPIC, scattering_phase
from .colour import luminance

F64 = NDArray[np.float64]


class AirLobe(NamedTuple):
    """`mean` (..., 3) radiance, and (...) its mean cosine `sharpness` to the way that it goes.

    `cosine` (...): of that way to a ray's direction of travel.
    """

    mean: F64
    sharpness: F64
    cosine: F64


def air_lobe(mean: ArrayLike, along: ArrayLike, travel: ArrayLike) -> AirLobe:
    """Of `mean` (..., 3) radiance, and `along` (..., 3): its luminance times the mean direction.

    `travel` (..., 3): unit length.
    """
    light, flow = np.maximum(mean, 0.0), np.asarray(along, np.float64)
    flux = np.linalg.norm(flow, axis=-1)
    sharpness = np.minimum(flux / np.maximum(luminance(light), 1e-20), 1.0)
    return AirLobe(light, sharpness, (flow * travel).sum(axis=-1) / np.maximum(flux, 1e-20))


def scattered_lobe(lobe: AirLobe, g: ArrayLike) -> F64:
    """(..., 3): what a medium of mean cosine `g` (3,) scatters of it into the ray.

    Radiance per length in the medium, times its scattering coefficient.
    """
    phase = scattering_phase(lobe.cosine[..., None], lobe.sharpness[..., None] * np.asarray(g))
    return np.asarray(lobe.mean * phase / ISOTROPIC)


def turned_lobe(wanted: AirLobe, given: AirLobe, g: ArrayLike) -> F64:
    """(..., 3): what a medium of mean cosine `g` (3,) scatters of a lobe along one way.

    Over what it scatters along another; both lobes are the same light, seen along these.
    """
    none = np.ones(3)
    one, other = (scattered_lobe(lobe._replace(mean=none), g) for lobe in (wanted, given))
    return np.asarray(one / other)
