"""sRGB against the standard's numbers; luminance weights."""

import numpy as np

from airlight.maths.colour import luminance, srgb_decode, srgb_encode


def test_srgb_known_values() -> None:
    # 18% grey is 117.6/255 = 0.4613 in sRGB; the linear piece has slope 12.92.
    np.testing.assert_allclose(srgb_encode([0.0, 1.0, 0.18, 0.001]), [0, 1, 0.46135612, 0.01292])


def test_srgb_round_trip_of_all_codes() -> None:
    codes = np.arange(256) / 255.0
    np.testing.assert_allclose(srgb_encode(srgb_decode(codes)), codes, atol=1e-7)


def test_srgb_is_monotone_across_the_joint() -> None:
    x = np.linspace(0.0030, 0.0033, 1001)
    assert (np.diff(srgb_encode(x)) > 0.0).all()


def test_luminance_of_white_is_one() -> None:
    np.testing.assert_allclose(luminance(np.ones((2, 5, 3))), np.ones((2, 5)))
