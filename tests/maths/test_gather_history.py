"""How far light of frames before is believed; WGSL against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import gather_history as history

RNG = np.random.default_rng(5)


def test_points_where_the_place_was_count_as_near_as_they_are():
    """The four around a place share its weight; others have a thousandth each."""
    at = np.array([0.3, 0.8])
    away = np.stack(np.meshgrid(np.arange(-1, 3), np.arange(-1, 3)), -1) - at
    weights = history.texel_share(away)
    assert weights.sum() == pytest.approx(1.0 + 16 * history.BESIDE)
    assert history.texel_share((0.0, 0.0)) == 1.0 + history.BESIDE
    assert history.texel_share((2.0, 0.0)) == history.BESIDE


def test_frames_count_as_far_as_their_surface_is_the_same():
    assert history.frames_kept(40.0, 1.0, 16.0) == 16.0
    assert history.frames_kept(4.0, 0.25, 16.0) == 2.0
    assert history.frames_kept(4.0, 0.0, 16.0) == 0.0


def test_light_within_its_noise_is_believed_and_other_light_is_not():
    """A mean of 1 with a deviation of .1: from .78 to 1.22 it may be noise."""
    before = np.array([0.3, 0.77, 0.9, 1.1, 1.3, 4.0])
    found = history.followed(before, 1.0, 0.01)
    np.testing.assert_allclose(found, [0.78, 0.78, 0.9, 1.1, 1.22, 1.22])
    frames = history.frames_believed(32.0, before, 1.0, 0.01)
    assert frames[0] == frames[-1] == 0.0
    np.testing.assert_allclose(frames[2:4], history.CHANGING)
    assert 0.0 < frames[4] < frames[1] < history.CHANGING


def test_twins(wgsl):
    away, best = RNG.normal(size=(500, 2)), RNG.random(500)
    frames, most = 20.0 * RNG.random((2, 500))
    near = wgsl("gather_history", "texel_share", away, returns="f32")
    np.testing.assert_allclose(near, history.texel_share(away), atol=1e-6)
    kept = wgsl("gather_history", "frames_kept", frames, best, most, returns="f32")
    np.testing.assert_allclose(
        kept, np.minimum(frames * np.clip(best / 0.5, 0, 1), most), rtol=1e-5
    )
    before, mean, variance = np.exp(RNG.normal(size=(3, 500)))
    reach = wgsl("gather_history", "noise_reach", mean, variance, returns="f32")
    np.testing.assert_allclose(reach, history.noise_reach(mean, variance), rtol=1e-5)
    found = wgsl("gather_history", "followed", before, mean, variance, returns="f32")
    np.testing.assert_allclose(found, history.followed(before, mean, variance), rtol=1e-5)
    found = wgsl("gather_history", "frames_believed", frames, before, mean, variance, returns="f32")
    twin = history.frames_believed(frames, before, mean, variance)
    np.testing.assert_allclose(found, twin, rtol=1e-3, atol=1e-4)
