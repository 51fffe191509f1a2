"""Where the sun stands, by place and time.

Source: Michalsky1988, the Astronomical Almanac's approximate formulas: within .01 degrees from 1950
to 2050.
"""

from __future__ import annotations

from datetime import datetime

import numpy as np

_J2000 = datetime(2000, 1, 1, 12)


def sun_angles_deg(utc: datetime, latitude_deg: float, longitude_deg: float) -> tuple[float, float]:
    """(elevation, azimuth) of the sun's centre without refraction; azimuth from north by east.

    `utc` is naive, `longitude_deg` positive eastwards.
    """
    days = (utc - _J2000).total_seconds() / 86400.0
    # The ecliptic: mean longitude, mean anomaly, longitude, obliquity.
    mean, anomaly = 280.460 + 0.9856474 * days, np.radians(357.528 + 0.9856003 * days)
    ecliptic = np.radians(mean + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2.0 * anomaly))
    tilt = np.radians(23.439 - 4e-7 * days)
    # The celestial equator.
    ascension = np.arctan2(np.cos(tilt) * np.sin(ecliptic), np.cos(ecliptic))
    declination = np.arcsin(np.sin(tilt) * np.sin(ecliptic))
    # The horizon: the hour angle is the local sidereal time less the right ascension.
    hours = utc.hour + utc.minute / 60.0 + utc.second / 3600.0
    midnight = days - hours / 24.0
    sidereal = 15.0 * (6.697375 + 0.0657098242 * midnight + 1.00273791 * hours)
    angle = np.radians(sidereal + longitude_deg) - ascension
    latitude = np.radians(latitude_deg)
    up = np.sin(declination) * np.sin(latitude)
    up += np.cos(declination) * np.cos(latitude) * np.cos(angle)
    east = -np.cos(declination) * np.sin(angle)
    north = np.sin(declination) * np.cos(latitude)
    north -= np.cos(declination) * np.sin(latitude) * np.cos(angle)
    elevation = float(np.degrees(np.arcsin(np.clip(up, -1.0, 1.0))))
    return elevation, float(np.degrees(np.arctan2(east, north)) % 360.0)
