"""What lights send by direction: shaders against the types' own words."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths.area_light import softened_gain
from airlight.scene.lights import LightSample, SpotLight

Evaluate = Callable[..., np.ndarray]

BY_DIRECTION = [
    SpotLight((0, 0, 0), (0, -1, 0), 1, inner_deg=15, outer_deg=40),
    SpotLight((0, 0, 0), (0, -1, 0), 1, inner_deg=30, outer_deg=30),
    LightSample((0, 0, 0), (0, -1, 0), (1, 1, 1)),
    LightSample((0, 0, 0), (0, -1, 0), (1, 1, 1), front=0.7, even=0.2),
]


@pytest.mark.parametrize("light", BY_DIRECTION)
def test_share_at(wgsl: Evaluate, light: SpotLight | LightSample) -> None:
    cosine = np.linspace(-1.0, 1.0, 257)
    row = light.row()
    shape = np.tile(np.array(row.shape), (len(cosine), 1))
    found = wgsl("light_kinds", "share_at", np.uint32(row.kind), cosine, shape)
    # A fade of 1e-4 in the cosine turns its rounding, 6e-8, into 1.5 * 6e-4.
    np.testing.assert_allclose(found, light.sent_share(cosine), atol=1e-3)


def test_softened_gain(wgsl: Evaluate) -> None:
    """As much as a point in all of space; 64 steps of an angle that makes the integrand smooth."""
    nearest = np.array([1e-4, 0.01, 0.3])[:, None]
    angle = (np.arange(64) + 0.5) * 0.5 * np.pi / 64
    squared = nearest / np.cos(angle) ** 2
    gain = softened_gain(nearest, squared)
    # r = sqrt(n) tan(angle), dr = s/sqrt(n) d(angle): 1 - r^2 gain/s, over all r.
    lost = (1.0 - np.sin(angle) ** 2 * gain) * squared
    assert np.abs(lost.mean(axis=1)).max() < 1e-9
    each = np.broadcast_to(nearest, gain.shape).ravel()
    found = wgsl("light_kinds", "softened_gain", each, squared.ravel())
    np.testing.assert_allclose(found, gain.ravel(), rtol=1e-6)
