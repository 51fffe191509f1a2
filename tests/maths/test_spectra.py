"""Spectra seen as colours: daylight is white, and Mitsuba's numbers are met."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.spectra import D65, emitted, reflected

ALL = (360.0, 830.0)


def test_daylight_is_white_as_light_and_on_white():
    """Rec.709's white is D65; its published chromaticity has four digits."""
    wavelengths = np.linspace(*ALL, len(D65))
    np.testing.assert_allclose(emitted(wavelengths, D65) / emitted(wavelengths, D65)[1], 1, 0, 2e-3)
    np.testing.assert_allclose(reflected(ALL, (1, 1)), 1.0, rtol=0, atol=2e-3)


def test_equal_energy_has_the_luminance_of_its_value_and_the_colour_of_illuminant_e():
    rgb = emitted(ALL, (2.0, 2.0))
    assert rgb @ (0.2126, 0.7152, 0.0722) == pytest.approx(2.0, rel=1e-3)
    np.testing.assert_allclose(rgb / 2.0, (1.2048, 0.9483, 0.9087), rtol=1e-3)


def test_nothing_lies_beyond_the_wavelengths_that_are_given():
    green = reflected((520.0, 560.0), (1.0, 1.0))
    assert green[1] > 0.1 and green[0] == green[2] == 0.0


@pytest.mark.parametrize(
    ("of", "values", "found"),
    [
        # Mitsuba 3.9 in llvm_ad_rgb, which sums 1000 steps; the Cornell box's lamp is the first.
        (emitted, (0.0, 8.0, 15.6, 18.4), (20.710836, 10.854634, 2.771152)),
        (reflected, (0.0, 8.0, 15.6, 18.4), (17.714712, 11.354429, 3.3045077)),
        (reflected, (0.3, 0.3, 0.3, 0.3), (0.2986026, 0.29992694, 0.29847273)),
    ],
)
def test_mitsubas_numbers_are_met(of, values, found):
    np.testing.assert_allclose(of((400, 500, 600, 700), values), found, rtol=2e-3)
