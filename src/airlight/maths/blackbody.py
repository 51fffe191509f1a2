"""Light of black bodies: Planck's law through the CIE 1931 observer, in linear Rec.709."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F32, F64
from .observer import FIRST_NM, LAST_NM, observer

PLANCK_J_S, LIGHT_M_S, BOLTZMANN_J_K = 6.62607015e-34, 299792458.0, 1.380649e-23
HOTTEST_K = 1e5
"""Beyond it the colour hardly changes; hotter voxels are taken for as hot."""
_COOLEST_K = 500.0  # a black body gives 1e-10 of what it does at 1500 K
_ENTRIES = 2048  # of the table, in equal steps of the inverse temperature

REC709_FROM_XYZ: F64 = np.array(
    [
        [3.2409699419, -1.5373831776, -0.4986107603],
        [-0.9692436363, 1.8759675015, 0.0415550574],
        [0.0556300797, -0.2039769589, 1.0569715142],
    ]
)
"""ITU-R BT.709 primaries, white D65."""


def planck(wavelength_m: ArrayLike, temperature_k: ArrayLike) -> F64:
    """Spectral radiance of a black body, W m^-2 sr^-1 per metre of wavelength."""
    length = np.asarray(wavelength_m, np.float64)
    quanta = PLANCK_J_S * LIGHT_M_S / (length * BOLTZMANN_J_K * np.asarray(temperature_k))
    # Beyond 700 an exponential is as good as infinite.
    few = np.expm1(np.minimum(quanta, 700.0))
    return np.asarray(2.0 * PLANCK_J_S * LIGHT_M_S**2 / (length**5 * few))


def xyz(temperature_k: ArrayLike) -> F64:
    """(..., 3), W m^-2 sr^-1: radiance of black bodies through the observer, whose y is 1 at most.

    Its Y times 683 is luminance in cd m^-2.
    """
    # One nanometre a step, in metres where Planck's law is asked.
    wavelength_nm = np.arange(FIRST_NM, LAST_NM + 1.0)
    kelvin = np.asarray(temperature_k, np.float64)[..., None]
    spectrum = planck(1e-9 * wavelength_nm, np.maximum(kelvin, 1.0))
    return np.asarray(1e-9 * (spectrum @ observer(wavelength_nm)))


def rec709(temperature_k: ArrayLike) -> F64:
    """(..., 3), W m^-2 sr^-1: linear Rec.709 of `xyz`; what lies outside of it is cut at 0.

    Below 1900 K that is a little of the blue: no display shows so deep an orange.
    """
    return np.asarray(np.maximum(xyz(temperature_k) @ REC709_FROM_XYZ.T, 0.0))


@lru_cache(maxsize=1)
def _table() -> tuple[F64, F64, F64]:
    """Inverse temperatures, K^-1, rising; the logarithm of Y there, and `rec709` over Y (n, 3)."""
    # Equal steps of 1/T, in which log(Y) is nearly a line.
    inverse = np.linspace(1.0 / HOTTEST_K, 1.0 / _COOLEST_K, _ENTRIES)
    luminance = xyz(1.0 / inverse)[:, 1]
    return inverse, np.log(luminance), rec709(1.0 / inverse) / luminance[:, None]


def rec709_of_grid(temperature_k: ArrayLike) -> F32:
    """(..., 3) float32: `rec709` of many temperatures, from a table; below 500 K nothing.

    log(Y) is nearly linear in 1/T (Wien's law), so the table is within 1e-3.
    """
    # Luminance and colour apart: the one spans decades, the other hardly changes.
    kelvin = np.asarray(temperature_k, np.float64)
    found = np.zeros((*kelvin.shape, 3), np.float32)
    glows = kelvin > _COOLEST_K
    at = 1.0 / kelvin[glows]
    inverse, logs, colours = _table()
    luminance = np.exp(np.interp(at, inverse, logs))
    for channel in range(3):
        found[glows, channel] = luminance * np.interp(at, inverse, colours[:, channel])
    return found
