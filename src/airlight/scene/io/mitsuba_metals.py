"""Metals that Mitsuba knows by name, and other conductors: what they mirror straight on."""

from __future__ import annotations

from ..checks import Rgb

METALS: dict[str, Rgb] = {
    "a-C": (0.212, 0.212, 0.200),
    "Ag": (0.972, 0.960, 0.915),
    "Al": (0.913, 0.921, 0.925),
    "AlAs": (0.282, 0.264, 0.448),
    "AlSb": (0.351, 0.385, 0.477),
    "Au": (1.000, 0.766, 0.336),
    "Be": (0.539, 0.538, 0.537),
    "Cr": (0.635, 0.662, 0.704),
    "CsI": (0.079, 0.081, 0.086),
    "Cu": (0.955, 0.637, 0.538),
    "Cu2O": (0.243, 0.265, 0.273),
    "CuO": (0.221, 0.217, 0.216),
    "d-C": (0.171, 0.173, 0.176),
    "Hg": (0.782, 0.780, 0.778),
    "HgTe": (0.405, 0.384, 0.385),
    "Ir": (0.701, 0.693, 0.656),
    "K": (0.950, 0.937, 0.920),
    "Li": (0.916, 0.889, 0.808),
    "MgO": (0.072, 0.073, 0.075),
    "Mo": (0.559, 0.579, 0.570),
    "Na": (0.977, 0.961, 0.936),
    "Nb": (0.504, 0.507, 0.505),
    "Ni": (0.659, 0.609, 0.526),
    "Rh": (0.797, 0.765, 0.742),
    "Se": (0.316, 0.270, 0.275),
    "SiC": (0.202, 0.206, 0.214),
    "SnTe": (0.365, 0.122, 0.031),
    "Ta": (0.389, 0.360, 0.412),
    "Te": (0.573, 0.593, 0.584),
    "ThF4": (0.042, 0.043, 0.043),
    "TiC": (0.489, 0.458, 0.445),
    "TiN": (0.614, 0.461, 0.233),
    "TiO2": (0.232, 0.245, 0.273),
    "V": (0.511, 0.528, 0.565),
    "VC": (0.470, 0.436, 0.414),
    "VN": (0.470, 0.410, 0.345),
    "W": (0.504, 0.498, 0.478),
    "none": (1.0, 1.0, 1.0),
}
"""Reflectance at normal incidence, linear Rec.709: Fresnel's formula of the indices of refraction
at each wavelength (refractiveindex.info, Palik), seen by daylight. Those of Ag, Al, Au, Cu and W
are Lagarde2011's, which are the same to .02.
"""


def metal(name: str) -> Rgb | None:
    """What the conductor `name` mirrors straight on; None for one that is not known."""
    return METALS.get(name.removesuffix("_palik"))


def mirrored(etas: Rgb, ks: Rgb) -> Rgb:
    """Fresnel's reflectance at normal incidence of complex indices of refraction, by channel."""
    r, g, b = (
        ((n - 1.0) ** 2 + k * k) / ((n + 1.0) ** 2 + k * k) for n, k in zip(etas, ks, strict=True)
    )
    return r, g, b
