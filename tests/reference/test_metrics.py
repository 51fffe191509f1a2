"""Scores against closed forms, brute force and the published behaviour of FLIP."""

from __future__ import annotations

import json
import math
import sys

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import airlight.reference
from airlight.errors import ReferenceFailure
from airlight.maths.colour import luminance
from airlight.reference import metrics, metrics_display
from airlight.scene.image import Image

RNG = np.random.default_rng(11)
TEXTURE = (RNG.random((48, 64, 3)) ** 2).astype(np.float32)


def grey(value, shape=(24, 32, 3)):
    return np.full(shape, value, np.float32)


def test_relmse_and_energy_of_flat_images_have_closed_forms():
    m = metrics.compare(Image(grey(0.6)), Image(grey(0.5)), perceptual=False)
    epsilon = 1e-4 * 0.25
    assert m.epsilon == pytest.approx(epsilon)
    assert m.relmse == pytest.approx(0.01 / (0.25 + epsilon), rel=1e-5)
    assert m.relmse_fixed == pytest.approx(0.01 / 0.26, rel=1e-5)
    assert (m.epsilon_fixed, m["energy_ratio"]) == (0.01, pytest.approx(1.2))
    assert m.signed_error == pytest.approx(0.1)
    assert m.relative_l2 == pytest.approx(0.2)
    assert m.black is not None
    assert m.black.relmse == pytest.approx(1 / (1 + 1e-4))
    assert m.black.signed_error == pytest.approx(-0.5)


def test_a_small_epsilon_does_not_flatter_a_black_image_as_a_large_one_does():
    dark = Image(0.02 * TEXTURE)
    black = metrics.compare(Image(np.zeros_like(TEXTURE)), dark, perceptual=False)
    assert black.relmse > 0.8
    assert black.relmse_fixed < 0.02


def test_the_noise_floor_is_the_relmse_of_an_independent_noisy_estimate():
    variance = (0.02 * TEXTURE**2 + 1e-5).astype(np.float32)
    noise = RNG.normal(size=(40, *TEXTURE.shape)) * np.sqrt(variance)
    epsilon = metrics.scene_epsilon(TEXTURE)
    # A perfect image against noisy references, seen from the other side.
    measured = np.mean([metrics.relmse(TEXTURE + n, TEXTURE, epsilon) for n in noise])
    assert metrics.noise_floor(variance, TEXTURE, epsilon) == pytest.approx(measured, rel=0.05)
    noisy = Image(TEXTURE, {"variance": variance})
    near = metrics.compare(Image((TEXTURE + noise[0]).astype(np.float32)), noisy, perceptual=False)
    far = metrics.compare(Image(TEXTURE * 0.0), noisy, perceptual=False)
    assert near.within_noise
    assert near.relative_l2 == pytest.approx(near.noise_floor_l2, rel=0.05)
    assert not far.within_noise


def test_psnr_is_twenty_decibels_for_a_tenth():
    low, high = grey(0.0), grey(metrics_display.srgb_encode(0.0))
    assert metrics_display.psnr_db(low, high, 0.0) == math.inf
    tenth = grey(((0.1 + 0.055) / 1.055) ** 2.4)
    assert metrics_display.psnr_db(low, tenth, 0.0) == pytest.approx(20.0, abs=1e-4)


def test_ssim_of_flat_images_is_its_luminance_term():
    a, b = 0.3, 0.5
    x, y = (grey(((v + 0.055) / 1.055) ** 2.4) for v in (a, b))
    want = (2 * a * b + 1e-4) / (a * a + b * b + 1e-4)
    assert metrics_display.ssim(x, y, 0.0) == pytest.approx(want, abs=1e-6)


@pytest.mark.parametrize("stops", [0.0, -1.0])
def test_ssim_equals_scipys_gaussian_windows(stops):
    other = np.clip(TEXTURE + 0.1 * RNG.normal(size=TEXTURE.shape), 0, 1).astype(np.float32)
    x, y = (luminance(metrics_display.displayed(a, stops)) for a in (TEXTURE, other))

    def blurred(a):
        return gaussian_filter(a, 1.5, radius=5, mode="constant")[5:-5, 5:-5]

    mx, my = blurred(x), blurred(y)
    vx, vy = blurred(x * x) - mx**2, blurred(y * y) - my**2
    cov = blurred(x * y) - mx * my
    top = (2 * mx * my + 1e-4) * (2 * cov + 9e-4)
    want = np.mean(top / ((mx**2 + my**2 + 1e-4) * (vx + vy + 9e-4)))
    assert metrics_display.ssim(TEXTURE, other, stops) == pytest.approx(want, abs=1e-9)
    assert metrics_display.ssim(TEXTURE, TEXTURE, stops) == pytest.approx(1.0)


@pytest.mark.needs("flip_evaluator")
def test_flip_is_zero_for_equal_images_and_near_one_for_opposites():
    white, black = grey(1.0, (64, 64, 3)), grey(0.0, (64, 64, 3))
    assert metrics_display.flip_map(TEXTURE, TEXTURE, 0.0).max() == 0.0
    assert metrics_display.flip_map(black, white, 0.0)[32, 32] > 0.9
    exposures = metrics_display.flip_exposures(TEXTURE)
    assert metrics_display.hdr_flip_map(TEXTURE, TEXTURE, exposures).max() == 0.0
    small, large = (
        metrics_display.hdr_flip_map(TEXTURE, TEXTURE * f, exposures).mean() for f in (1.1, 2.0)
    )
    assert 0.0 < small < large < 1.0


@pytest.mark.needs("flip_evaluator")
def test_flip_exposures_agree_with_flips_own_choice():
    import flip_evaluator

    smooth = np.linspace(0.01, 4.0, 20 * 3000).reshape(200, 300)[..., None] * np.ones(3)
    image = smooth.astype(np.float32)
    _, _, own = flip_evaluator.evaluate(image, image, "HDR", inputsRGB=False, applyMagma=False)
    start, stop = metrics_display.flip_exposures(image)
    assert start == pytest.approx(own["startExposure"], abs=0.01)
    assert stop == pytest.approx(own["stopExposure"], abs=0.05)


def test_a_black_reference_is_no_crash():
    m = metrics.compare(Image(grey(0.1)), Image(grey(0.0)))
    assert m.energy_ratio is None
    assert m.omitted["energy_ratio"] == "the reference is black"
    assert m.to_json()["relmse"] is None
    assert metrics.compare(Image(grey(0.0)), Image(grey(0.0)), perceptual=False).relmse == 0.0


def test_without_flip_it_is_left_out_with_a_reason(monkeypatch):
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    m = metrics.compare(Image(TEXTURE), Image(TEXTURE))
    assert (m.flip, m.hdr_flip) == (None, None)
    assert m.omitted["flip"].startswith("flip-evaluator is not installed")


def test_layers_are_scored_each_beside_black_and_direct_alone():
    reference = Image(
        TEXTURE * 3,
        {"direct": TEXTURE, "indirect": TEXTURE * 2, "indirect_variance": TEXTURE * 0 + 1e-6},
    )
    image = Image(TEXTURE * 2, {"direct": TEXTURE, "indirect": TEXTURE, "depth": TEXTURE[..., 0]})
    m = airlight.reference.compare(image, reference, perceptual=False)
    assert set(m.layers) == {"direct", "indirect"}
    assert m.layers["direct"].relmse == 0.0
    assert m.layers["indirect"].energy_ratio == pytest.approx(0.5)
    assert m.layers["indirect"].noise_floor > 0.0
    assert m.direct_only.energy_ratio == pytest.approx(1 / 3)
    assert json.loads(json.dumps(m.to_json()))["layers"]["indirect"]["black"]["relmse"] > 0.5


def test_equal_time_follows_one_over_n():
    e = metrics.equal_time(0.03, 0.5, floor=0.01, samples=64, reference_seconds=32.0)
    assert e.unit_error == pytest.approx(0.64)
    assert e.error_at_time == pytest.approx(0.64)  # one sample in half a second
    assert e.samples_to_match == pytest.approx(0.64 / 0.02)
    assert e.seconds_to_match == pytest.approx(16.0)
    lost = metrics.equal_time(0.015, 0.5, floor=0.01, samples=64, reference_seconds=32.0)
    assert lost.to_json()["seconds_to_match"] is None


def test_bad_images_are_refused_by_name():
    with pytest.raises(ReferenceFailure, match="the image is 64x48, the reference 32x24"):
        metrics.compare(Image(TEXTURE), Image(grey(1.0)))
    broken = TEXTURE.copy()
    broken[3, 4] = np.nan
    with pytest.raises(ReferenceFailure, match="1 pixels of the image are NaN or infinite"):
        metrics.compare(Image(broken), Image(TEXTURE))
    with pytest.raises(ReferenceFailure, match="1 pixels of the reference are NaN"):
        metrics.compare(Image(TEXTURE), Image(broken))
