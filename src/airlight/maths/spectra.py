"""Spectra as linear Rec.709, as Mitsuba reduces them for images of three channels."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .blackbody import REC709_FROM_XYZ
from .observer import FIRST_NM, LAST_NM, observer

_D65 = """
    46.6383 52.0891 49.9755 54.6482 82.7549 91.486 93.4318 86.6823 104.865 117.008 117.812 114.861
    115.923 108.811 109.354 107.802 104.79 107.689 104.405 104.046 100 96.3342 95.788 88.6856
    90.0062 89.5991 87.6987 83.2886 83.6992 80.0268 80.2146 82.2778 78.2842 69.7213 71.6091 74.349
    61.604 69.8856 75.087 63.5927 46.4182 66.8054 63.3828 64.304 59.4519 51.959 57.4406 60.3125
"""  # CIE 15:2004, table T.1, from 360 nm in steps of 10
D65: F64 = np.array(_D65.split(), np.float64)
"""Relative power of standard daylight from FIRST_NM to LAST_NM in steps of 10 nm."""


def emitted(wavelengths_nm: ArrayLike, values: ArrayLike) -> F64:
    """(3,) of light with `values` at rising wavelengths, linear between them, nothing beyond.

    In units of the values: a spectrum of 1 has a luminance of 1. It is no white, which daylight is
    in Rec.709, but a little red.
    """
    return _seen(wavelengths_nm, values, np.ones(len(D65)))


def reflected(wavelengths_nm: ArrayLike, values: ArrayLike) -> F64:
    """(3,) of what reflects or dims by `values`, seen by daylight: 1 everywhere is white."""
    return _seen(wavelengths_nm, values, D65)


def _seen(wavelengths_nm: ArrayLike, values: ArrayLike, light: F64) -> F64:
    # Through the observer, one nanometre a step; colours outside of Rec.709 are cut at 0.
    fine = np.arange(FIRST_NM, LAST_NM + 1.0)
    lit = np.interp(fine, np.linspace(FIRST_NM, LAST_NM, len(light)), light)
    weights = observer(fine) * lit[:, None]
    found = np.interp(fine, np.asarray(wavelengths_nm), np.asarray(values), 0.0, 0.0) @ weights
    rgb = REC709_FROM_XYZ @ (found / weights[:, 1].sum())
    return np.asarray(np.maximum(rgb, 0.0))
