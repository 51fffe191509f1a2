"""Rays towards what lights shine on: cones against integrals; WGSL against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import light_guide
from airlight.maths.sampling import fibonacci_sphere

RNG = np.random.default_rng(23)


def test_directions_fill_a_cone_evenly():
    """Their mean cosine from the axis is that of the middle height, none is outside."""
    axis, numbers = np.array([0.6, 0.0, 0.8]), RNG.random((20000, 2))
    for height in (1e-5, 0.1, 1.0):
        drops = 1.0 - light_guide.cone_direction(axis, height, numbers) @ axis
        assert drops.max() < height * (1.0 + 1e-6) + 1e-12
        # The mean of 20000 uniform numbers is off by .002.
        assert drops.mean() == pytest.approx(0.5 * height, rel=0.02)


def patches(count):
    """Spheres of .02 to 1 m around a point, some of which overlap, some with mixed normals."""
    centres = RNG.normal(size=(count, 3))
    centres *= RNG.uniform(1.5, 4.0, (count, 1)) / np.linalg.norm(centres, axis=1, keepdims=True)
    normals = RNG.normal(size=(count, 3))
    normals *= RNG.uniform(0.1, 1.0, (count, 1)) / np.linalg.norm(normals, axis=1, keepdims=True)
    radii, powers = 10.0 ** RNG.uniform(-1.7, 0.0, count), RNG.uniform(0.5, 2.0, count)
    return np.column_stack([centres, radii, normals, powers])


def test_guided_rays_are_as_many_as_their_density_says():
    """It is 1 over the sphere; 400,000 even directions see cones of .02 rad within 2 %."""
    density, found = light_guide.guide_density(
        patches(light_guide.PATCHES), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), fibonacci_sphere(400000)
    )
    assert 4.0 * np.pi * density.mean() == pytest.approx(1.0, rel=0.02)
    assert 0.0 < found < 1.0


def test_a_patch_behind_or_turned_away_gets_no_rays():
    ahead = [0.0, 2.0, 0.0, 0.1, 0.0, -1.0, 0.0, 1.0]
    behind, turned = [0.0, -2.0, *ahead[2:]], [*ahead[:5], 1.0, *ahead[6:]]
    up = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    for lit in (behind, turned):
        density, found = light_guide.guide_density([lit], np.zeros(3), up[0], up)
        assert density.max() == 0.0 and found == 1.0
    density, found = light_guide.guide_density([ahead, behind], np.zeros(3), up[0], up)
    assert density[0] == pytest.approx(1.0 / (np.pi * 0.05**2), rel=2e-3)
    assert density[1] == 0.0 and found == pytest.approx(0.05**2, rel=0.01)


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
