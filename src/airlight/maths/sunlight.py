"""Spectra of the sun and the sky as linear Rec.709, and both as maps and irradiances.

A radiance of (1, 1, 1) W m^-2 sr^-1 is taken for 179 cd m^-2: the luminous efficacy of daylight
over the visible spectrum (Ward1994), so that what 100,000 lux fall on receives 559 W m^-2.
"""

from __future__ import annotations

import numpy as np

from .arrays import F64
from .atmosphere import (
    WAVELENGTHS_NM,
    Air,
    air_phase,
    bilinear,
    haze_phase,
    sky_parts,
    transmittance_out,
)
from .latlong import latlong_row_solid_angles, latlong_texel_directions

EFFICACY_LM_PER_W = 179.0
SUN_RADIUS_DEG = 0.2665
SOLAR_CONSTANT = 1361.0
"""W m^-2 at the mean distance of the Earth (Kopp2011)."""
_SUN_K = 5772.0
_RGB_FROM_XYZ = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)  # IEC 61966-2-1
_ELEVATIONS, _AZIMUTHS = 40, 21


def sun_spectrum(wavelengths_nm: F64) -> F64:
    """The sun's irradiance outside the air, W m^-2 nm^-1, by Planck's law at 5772 K."""
    # Planck's radiance over the whole that it integrates to, times the solar constant.
    metres = wavelengths_nm * 1e-9
    planck = 2.0 * 6.62607015e-34 * 299792458.0**2 / metres**5
    planck /= np.expm1(6.62607015e-34 * 299792458.0 / (metres * 1.380649e-23 * _SUN_K))
    whole = 5.670374419e-8 * _SUN_K**4 / np.pi
    return np.asarray(SOLAR_CONSTANT * planck / whole * 1e-9)


def colour_matching(wavelengths_nm: F64) -> F64:
    """The CIE 1931 2 degree functions (N, 3) at wavelengths (N,).

    Source: Wyman2013, the multi-lobe fits of listing 1.
    """

    def lobe(height: float, middle: float, below: float, above: float) -> F64:
        t = wavelengths_nm - middle
        return np.asarray(height * np.exp(-0.5 * (t * np.where(t < 0.0, below, above)) ** 2))

    # Each curve is a sum of lobes with two slopes.
    x = lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323)
    x = x + lobe(-0.065, 501.1, 0.0490, 0.0382)
    y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)
    z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)
    return np.stack([x, y, z], axis=1)


def rgb_of_sunlight() -> F64:
    """(W, 3): linear Rec.709, in W m^-2, of a share of the sun's irradiance at each wavelength."""
    fine = np.arange(360.0, 781.0, 1.0)
    # Between two of the wavelengths a share is linear; the sun and the eye are not.
    tents = np.stack([np.interp(fine, WAVELENGTHS_NM, row) for row in np.eye(len(WAVELENGTHS_NM))])
    xyz = (tents * sun_spectrum(fine)) @ colour_matching(fine) * 683.0
    return np.asarray(xyz @ _RGB_FROM_XYZ.T / EFFICACY_LM_PER_W)


def sun_irradiance(air: Air, elevation_deg: float) -> F64:
    """Irradiance (3,), W m^-2, that the sun gives a surface which faces it; 0 where it has set."""
    # What air, haze and ozone transmit of the sun, by wavelength.
    cosine = np.sin(np.radians(max(elevation_deg, 0.0)))
    share = transmittance_out(air, np.array(0.0), np.array(cosine))
    # The horizon cuts the disk.
    seen = float(np.clip(0.5 + 0.5 * elevation_deg / SUN_RADIUS_DEG, 0.0, 1.0))
    return np.asarray(np.maximum(share @ rgb_of_sunlight(), 0.0) * seen)


def sky_map(air: Air, towards_sun: F64, height: int) -> F64:
    """Radiance (height, 2 height, 3), W m^-2 sr^-1, of sky and ground around a unit vector to the
    sun, +Y up. The ground is what sun and sky light: grey, matte, without an end."""
    # The upper half is the sky; below it lies the ground.
    directions = latlong_texel_directions(height, 2 * height)
    sky = sky_radiance(air, towards_sun, directions[: height // 2])
    solid_angles = latlong_row_solid_angles(height, 2 * height)[: height // 2]
    # What sky and sun send onto the level ground, W m^-2.
    weights = directions[: height // 2, :, 1] * solid_angles[:, None]
    received = (sky * weights[..., None]).sum(axis=(0, 1))
    elevation_deg = float(np.degrees(np.arcsin(np.clip(towards_sun[1], -1.0, 1.0))))
    received += sun_irradiance(air, elevation_deg) * max(float(towards_sun[1]), 0.0)
    # Matte ground reflects albedo / pi of it in all directions.
    below = np.broadcast_to(air.ground / np.pi * received, (height - height // 2, 2 * height, 3))
    return np.concatenate([sky, below])


def sky_radiance(air: Air, towards_sun: F64, directions: F64) -> F64:
    """Radiance (..., 3), W m^-2 sr^-1, of the sky in unit `directions` (..., 3) above the horizon.

    Its parts without phase functions are smooth: they are computed for some views, dense near the
    horizon, and read between them.
    """
    # The table: elevations dense near the horizon, azimuths from the sun's on one side.
    up = float(np.arcsin(np.clip(towards_sun[1], -1.0, 1.0)))
    rows = np.linspace(0.0, 1.0, _ELEVATIONS) ** 2 * np.pi / 2.0
    columns = np.linspace(0.0, np.pi, _AZIMUTHS)
    elevation, azimuth = (a.ravel() for a in np.meshgrid(rows, columns, indexing="ij"))
    parts = sky_parts(air, elevation, azimuth, up)
    table = np.concatenate(
        [part @ rgb_of_sunlight() for part in (parts.air, parts.haze, parts.often)], axis=-1
    ).reshape(_ELEVATIONS, _AZIMUTHS, 9)
    # Where each direction lies in it; the sky is alike on both sides of the sun.
    heights = np.arcsin(np.clip(directions[..., 1], 0.0, 1.0))
    turn = np.arctan2(directions[..., 0], directions[..., 2])
    beside = turn - np.arctan2(towards_sun[0], towards_sun[2])
    column = np.abs((beside + np.pi) % (2.0 * np.pi) - np.pi) / np.pi * (_AZIMUTHS - 1)
    row = np.sqrt(heights / (np.pi / 2.0)) * (_ELEVATIONS - 1)
    read = bilinear(table, row, column)
    # Single scattering times its phase functions, plus what is scattered more often.
    cosine = np.clip(directions @ towards_sun, -1.0, 1.0)[..., None]
    once = read[..., :3] * air_phase(cosine) + read[..., 3:6] * haze_phase(cosine)
    return np.asarray(np.maximum(once + read[..., 6:], 0.0))
