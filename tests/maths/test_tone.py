"""Tone curves: black, grey, white, monotony, published values; exposure; 8-bit output."""

import numpy as np
import pytest

from airlight.maths import tone
from airlight.maths.colour import srgb_encode

GREYS = np.repeat(np.concatenate([[0.0], np.geomspace(1e-6, 1e6, 4001)])[:, None], 3, axis=1)


@pytest.mark.parametrize("name", tone.TONE_CURVES)
def test_grey_goes_from_black_to_white_without_turning(name: str) -> None:
    shown = tone.tone_map(GREYS, 0.0, name)
    assert shown.min() >= 0.0
    assert shown.max() <= 1.0
    np.testing.assert_allclose(shown[0], 0.0, atol=1e-12)
    assert (shown[-1] > 0.99).all()
    assert (np.diff(shown, axis=0) >= -1e-12).all()
    # grey stays grey: Hill's printed matrices are rounded to 5 digits
    assert np.ptp(shown, axis=1).max() < 2e-5


@pytest.mark.parametrize(("name", "expected"), [("none", 0.18), ("agx", 0.2176), ("aces", 0.2131)])
def test_middle_grey(name: str, expected: float) -> None:
    np.testing.assert_allclose(tone.tone_map([[0.18] * 3], 0.0, name), expected, atol=1e-4)


def test_neutral_keeps_colours_below_its_compression() -> None:
    # Khronos: c_out = c_in - 0.04 between 2 F90 and 0.8.
    c = [[0.5, 0.3, 0.1], [0.78, 0.2, 0.09]]
    np.testing.assert_allclose(tone.neutral(c), np.array(c) - 0.04, atol=1e-12)


def test_agx_bends_match_the_published_curve() -> None:
    # the constants that others ship for the same sigmoid
    assert pytest.approx(59.507875, rel=1e-8) == tone.AGX_TOE_BEND
    assert pytest.approx(69.86278913545539, rel=1e-10) == tone.AGX_SHOULDER_BEND
    np.testing.assert_allclose(tone.agx_curve([0.0, tone.AGX_PIVOT, 1.0]), [0.0, 0.5, 1.0])


def test_agx_agrees_with_wrenschs_polynomial() -> None:
    x = np.linspace(0.05, 0.95, 50)
    fit = 15.5 * x**6 - 40.14 * x**5 + 31.96 * x**4 - 6.868 * x**3 + 0.4298 * x**2 + 0.1191 * x
    np.testing.assert_allclose(tone.agx_curve(x), fit - 0.00232, atol=6e-3)


def test_exposure_is_in_stops() -> None:
    c = np.random.default_rng(1).random((7, 3))
    np.testing.assert_allclose(tone.tone_map(c, 2.0, "agx"), tone.tone_map(4.0 * c, 0.0, "agx"))


def test_unknown_curve_is_named() -> None:
    with pytest.raises(ValueError, match="tone curve 'reinhard' is unknown; known: none, agx"):
        tone.tone_map([[0.0] * 3], 0.0, "reinhard")
    with pytest.raises(ValueError, match="'reinhard'"):
        tone.display_srgb8(np.zeros((1, 1, 3)), 0.0, "reinhard")


@pytest.mark.parametrize("name", tone.TONE_CURVES)
def test_bad_pixels_become_black(name: str) -> None:
    bad = np.array([[[np.nan] * 3, [np.inf] * 3, [-np.inf] * 3, [-1.0] * 3]])
    shown = tone.display_srgb8(bad, 0.0, name)
    assert shown.dtype == np.uint8
    assert shown.shape == (1, 4, 3)
    assert not shown.any()


def test_display_rounds_to_the_nearest_code() -> None:
    ramp = np.linspace(0.0, 1.0, 256)
    linear = np.where(ramp <= 0.04045, ramp / 12.92, ((ramp + 0.055) / 1.055) ** 2.4)
    shown = tone.display_srgb8(np.repeat(linear[None, :, None], 3, axis=2), 0.0, "none")
    np.testing.assert_array_equal(shown[0, :, 0], np.arange(256))


def test_dither_keeps_the_mean_and_stays_within_a_code() -> None:
    flat = np.full((64, 64, 3), 0.1807)
    plain = tone.display_srgb8(flat, 0.0, "none").astype(int)
    dithered = tone.display_srgb8(flat, 0.0, "none", dither=True).astype(int)
    assert np.abs(dithered - plain).max() == 1
    assert np.ptp(dithered, axis=2).max() == 0  # grey stays grey
    assert dithered.mean() == pytest.approx(255.0 * float(srgb_encode(0.1807)), abs=1.0 / 64)


def test_dither_hides_the_bands_of_a_smooth_sky() -> None:
    sky = np.repeat(np.linspace(0.10, 0.11, 200)[:, None, None], 3, axis=2)  # 4 codes in 200 rows
    sky = np.broadcast_to(sky, (200, 64, 3))
    true = 255.0 * srgb_encode(sky[..., 0])
    misses = []
    for dither in (False, True):
        shown = tone.display_srgb8(sky, 0.0, "none", dither=dither)[..., 0]
        # As an eye sees it from some way off: blocks of 8 x 8 pixels.
        off = (shown - true).reshape(25, 8, 8, 8).mean(axis=(1, 3))
        misses.append(float(np.abs(off).max()))
    assert misses[0] > 0.3
    assert misses[1] < 0.08


def test_dither_leaves_whole_codes_alone() -> None:
    ramp = np.arange(256) / 255.0
    linear = np.where(ramp <= 0.04045, ramp / 12.92, ((ramp + 0.055) / 1.055) ** 2.4)
    image = np.broadcast_to(linear[None, :, None], (64, 256, 3))
    shown = tone.display_srgb8(image, 0.0, "none", dither=True)
    np.testing.assert_array_equal(
        shown, np.broadcast_to(np.arange(256)[None, :, None], shown.shape)
    )


def test_dither_is_even_at_every_scale() -> None:
    codes = tone.dither_codes(96, 96)
    assert np.abs(codes).max() <= 0.5
    for side in (4, 8, 16):
        means = codes.reshape(96 // side, side, 96 // side, side).mean(axis=(1, 3))
        # White noise of the same width: .283 / side.
        assert means.std() < 0.5 * 0.283 / side


def test_auto_exposure() -> None:
    assert tone.auto_exposure(np.full((4, 4, 3), 0.18)) == pytest.approx(0.0)
    assert tone.auto_exposure(np.full((4, 4, 3), 0.18 / 8.0)) == pytest.approx(3.0)
    assert tone.auto_exposure(np.zeros((4, 4, 3))) == 0.0
    # a lamp of a few pixels, black sky and a NaN do not decide
    image = np.full((100, 100, 3), 0.36)
    image[:1], image[1:40], image[50, 50] = 1e6, 0.0, np.nan
    assert tone.auto_exposure(image) == pytest.approx(-1.0, abs=0.1)
