"""What the units of a variable of a simulation say of light: extinction, or droplets of water.

Extinction is 3 q / (2 rho r), q the water by volume, rho its density and r the droplets' effective
radius. Densities are kg m^-3 of droplets of 10 micrometres: water in droplets of half that radius
counts twice, so one sigma_t holds for the whole grid.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import F32, F64
from .dense_grid import Optics

RADIUS_M = 1e-5
"""Of the droplets of a fair-weather cloud; all light is scattered, ahead."""
_PER_KG = 1.5 / (1000.0 * RADIUS_M)  # m^2 of extinction per kg of water: 3 / (2 rho r)
_AIR_KG_M3, _AIR_FALLS_M = 1.2, 8500.0
_INVERSE_M = {"m-1": 1.0, "1/m": 1.0, "m^-1": 1.0, "m**-1": 1.0, "km-1": 1e-3, "1/km": 1e-3}
_CONTENT = {"kg m-3": 1.0, "kg/m3": 1.0, "kg/m^3": 1.0, "kg m**-3": 1.0}
_CONTENT |= {"g m-3": 1e-3, "g/m3": 1e-3, "g/m^3": 1e-3, "g m**-3": 1e-3}
_MIXING = {"kg kg-1": 1.0, "kg/kg": 1.0, "kg kg**-1": 1.0, "g/g": 1.0}
_MIXING |= {"g kg-1": 1e-3, "g/kg": 1e-3, "g kg**-1": 1e-3}
_LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6}
_LENGTHS |= {"microns": 1e-6, "micrometer": 1e-6, "micrometre": 1e-6, "micrometers": 1e-6}
_LENGTHS |= {"micrometres": 1e-6, "1e-6 m": 1e-6, "10^-6 m": 1e-6}
_RADII: tuple[str, ...] = (
    "re",
    "reff",
    "r_eff",
    "rel",
    "re_liq",
    "re_cloud",
    "reffc",
    "effective_radius",
)
_RADII += ("effc", "eff_radius_qc")
_LIQUID = ("qc", "ql", "qcloud", "clw", "lwc", "q_liquid", "cloud_water", "rcloud", "qn")


def radius_of(variable: Any, dataset: Any) -> Any | None:
    """The variable with the effective radius of the droplets that `variable` is the water of.

    It is known by the CF conventions' standard name or by the names of models, and has the same
    dimensions. None where there is none, or where `variable` is no liquid water of clouds.
    """
    standard = str(variable.attrs.get("standard_name", "")).lower()
    is_liquid = str(variable.name).lower() in _LIQUID or "cloud_liquid_water" in standard
    if not is_liquid or _key(variable) not in (*_CONTENT, *_MIXING):
        return None
    for name, found in dataset.data_vars.items():
        said = str(found.attrs.get("standard_name", "")).lower()
        is_radius = str(name).lower() in _RADII or said.startswith(
            "effective_radius_of_cloud_liquid_water"
        )
        if is_radius and set(found.dims) == set(variable.dims) and found.dtype.kind == "f":
            return found
    return None


def is_length(radius: Any) -> bool:
    """Whether a radius is in units that are known here."""
    return _key(radius) in _LENGTHS


def as_opaque(water: NDArray[Any], radius: NDArray[Any], about: Any) -> NDArray[Any]:
    """Water of droplets of RADIUS_M that is as opaque as `water` in droplets of `radius`.

    `about` is the radius's variable, which has its units. A radius that is missing or not above 0
    counts as RADIUS_M.
    """
    to_m = _LENGTHS[_key(about)]
    metres = np.asarray(radius, np.float64) * to_m
    is_there = np.isfinite(metres) & (metres > 0.0)
    scale = RADIUS_M / np.where(is_there, metres, RADIUS_M)
    return np.asarray(water * scale, np.float32)


def optical(values: F32, heights_m: F64, units: str, radius: str = "") -> tuple[F32, Optics | None]:
    """Values in m^-1 or kg m^-3 where the units are of extinction or water; what that means.

    `values` (z, y up, x), `heights_m` of their cells. `radius` is the name of the droplets' radius,
    if `as_opaque` used one.
    """
    key = " ".join(units.split())
    if key in _INVERSE_M:
        return values * np.float32(_INVERSE_M[key]), Optics(
            1.0, 0.999, 0.85, f"its values in {units} are the extinction"
        )
    if key not in _CONTENT and key not in _MIXING:
        return values, None
    size = f"of {RADIUS_M * 1e6:g} micrometres"
    if radius:
        size = f"as large as '{radius}' says, counted as ones {size} that are as opaque"
    text = f"its values in {units} are water in droplets {size}"
    # Mixing ratios times the density of air, which falls with height, are water by volume.
    if key in _CONTENT:
        water = values * np.float32(_CONTENT[key])
    else:
        air = _AIR_KG_M3 * np.exp(-heights_m / _AIR_FALLS_M) * _MIXING[key]
        water = values * air.astype(np.float32)[None, :, None]
    return water, Optics(_PER_KG, 1.0, 0.86, text)


def _key(variable: Any) -> str:
    return " ".join(str(variable.attrs.get("units", "")).split())
