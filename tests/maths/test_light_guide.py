"""Rays towards what lights shine on: cones against integrals; WGSL against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import light_guide

RNG = np.random.default_rng(23)


def test_directions_fill_a_cone_evenly():
    """Their mean cosine from the axis is that of the middle height, none is outside."""
    axis, numbers = np.array([0.6, 0.0, 0.8]), RNG.random((20000, 2))
    for height in (1e-5, 0.1, 1.0):
        drops = 1.0 - light_guide.cone_direction(axis, height, numbers) @ axis
        assert drops.max() < height * (1.0 + 1e-6) + 1e-12
        # The mean of 20000 uniform numbers is off by .002.
        assert drops.mean() == pytest.approx(0.5 * height, rel=0.02)


def test_wgsl_twins(wgsl):
    axes = RNG.normal(size=(64, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    heights, numbers = 10.0 ** RNG.uniform(-4, 0, 64), RNG.random((64, 2))
    found = wgsl("guided_share", "cone_direction", axes, heights, numbers, returns="vec3f")
    np.testing.assert_allclose(found, light_guide.cone_direction(axes, heights, numbers), atol=2e-5)
    shares = np.append(RNG.random(63), 0.0)
    np.testing.assert_allclose(
        wgsl("guided_share", "guided_share", shares, returns="f32"),
        light_guide.guided_share(shares),
        rtol=1e-5,
    )
