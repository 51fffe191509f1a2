"""The sun's place against published ones."""

from __future__ import annotations

from datetime import datetime

import pytest

from airlight.maths.sun_position import sun_angles_deg


def test_the_example_of_the_solar_position_algorithm():
    """Reda2004, table A5.1: Golden, Colorado, 2003-10-17 12:30:30 at UTC-7."""
    elevation, azimuth = sun_angles_deg(datetime(2003, 10, 17, 19, 30, 30), 39.742476, -105.1786)
    refraction = 0.0164  # of which its zenith angle of 50.11162 degrees takes account
    assert elevation + refraction == pytest.approx(90.0 - 50.11162, abs=0.01)
    assert azimuth == pytest.approx(194.34024, abs=0.01)


def test_equinox_and_solstices():
    """2024-03-20 03:06 and 2024-06-20 20:51 UTC: declinations 0 and 23.44 degrees."""
    # At the pole the elevation is the declination, whatever the hour.
    at_equinox, _ = sun_angles_deg(datetime(2024, 3, 20, 3, 6), 90.0, 0.0)
    at_solstice, _ = sun_angles_deg(datetime(2024, 6, 20, 20, 51), 90.0, 0.0)
    assert at_equinox == pytest.approx(0.0, abs=0.01)
    assert at_solstice == pytest.approx(23.44, abs=0.01)


def test_it_rises_in_the_east_and_stands_in_the_south_at_noon():
    _, morning = sun_angles_deg(datetime(2024, 3, 20, 6, 30), 50.0, 0.0)
    _, noon = sun_angles_deg(datetime(2024, 3, 20, 12, 7), 50.0, 0.0)
    _, southern = sun_angles_deg(datetime(2024, 3, 20, 12, 7), -50.0, 0.0)
    assert morning == pytest.approx(92.0, abs=6.0)
    assert noon == pytest.approx(180.0, abs=1.0)
    assert min(southern, 360.0 - southern) == pytest.approx(0.0, abs=1.0)
