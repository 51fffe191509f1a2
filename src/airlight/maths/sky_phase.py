"""The exact single scattering of a sky over that of its ordinates.

A few ordinates and a narrow phase function show as spots. Where the sky's transmittance varies less
than its light, the exact sum over the sky differs from the ordinates' by a factor of the direction
alone: the map convolved with the phase function, over the ordinates' sum. Multiplied by it, single
scattering in thin media is exact at any number of ordinates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .beam_phase import beam_phase
from .latlong import latlong_row_solid_angles, latlong_texel_directions
from .ordinates import Ordinates
from .phase import henyey_greenstein

ROWS = 64  # of the convolved map
LARGEST_GAIN = 8.0


def convolved(radiance: ArrayLike, g: ArrayLike) -> F64:
    """(h, w, channel): the integral of L(t) HG(t.s, g) over the sphere, by direction s.

    `radiance` is a latitude-longitude map (H, W, channel), first averaged to at most ROWS rows;
    `g` (channel,). Rows are convolved along longitude in frequency space. What is narrower than
    a texel keeps its integral.
    """
    # Between two rows the phase function depends on the difference of longitudes alone.
    light = _shrunk(np.asarray(radiance, dtype=np.float64))
    height, width = light.shape[:2]
    omega = latlong_row_solid_angles(height, width)
    direction = latlong_texel_directions(height, width)
    cosine = np.einsum("ik,jwk->ijw", direction[:, 0], direction)
    waves = np.fft.rfft(light * omega[:, None, None], axis=1)
    channels = []
    # So each pair of rows is a product of Fourier series; kernels are normalised on the map.
    for channel, anisotropy in enumerate(np.asarray(g, dtype=np.float64)):
        kernel = henyey_greenstein(cosine, anisotropy)
        kernel /= np.einsum("ijw,j->i", kernel, omega)[:, None, None]
        kernel_waves = np.fft.rfft(kernel, axis=2)
        product = np.einsum("ijw,jw->iw", kernel_waves, waves[..., channel])
        channels.append(np.fft.irfft(product, n=width, axis=1))
    return np.maximum(np.stack(channels, axis=-1), 0.0)


def sky_gain(exact: F64, ordinates: Ordinates, table: F64) -> F64:
    """(h, w, channel): `exact`, the map `convolved`, over the ordinates' own sum, by direction
    towards the sky.

    `ordinates` of the same map, `table` their `beam_phase_table`. Within LARGEST_GAIN.
    """
    # The ordinates' own sum, as single scattering has it.
    towards = latlong_texel_directions(*exact.shape[:2])
    own = np.zeros_like(exact)
    for n in range(ordinates.count):
        cosine = -(towards @ ordinates.direction[n])
        own += ordinates.irradiance[n] * beam_phase(table[n], cosine)
    # A little of both: where the sky is black the gain is 1.
    least = 1e-6 * max(float(exact.max()), 1e-300)
    gain = (exact + least) / (own + least)
    return np.asarray(np.clip(gain, 1.0 / LARGEST_GAIN, LARGEST_GAIN))


def _shrunk(radiance: F64) -> F64:
    """Blocks averaged by solid angle; the last rows and columns that fill no block are left out."""
    # Whole blocks, their rows weighted by the sine of the polar angle.
    height, width = radiance.shape[:2]
    rows, columns = max(1, height // ROWS), max(1, width // (2 * ROWS))
    height, width = height // rows * rows, width // columns * columns
    weight = np.sin((np.arange(height) + 0.5) * np.pi / height)[:, None, None]
    weighted = (radiance[:height, :width] * weight).reshape(
        height // rows, rows, width // columns, columns, -1
    )
    return np.asarray(
        weighted.mean(axis=(1, 3)) / weight.reshape(-1, rows).mean(axis=1)[:, None, None]
    )
