"""What passes translucent surfaces, and the chance by which maps show them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths.translucency import chance, dielectric_fresnel, passed_share

Evaluate = Callable[..., np.ndarray]
RNG = np.random.default_rng(7)
COUNT = 2000


def single(x: np.ndarray) -> np.ndarray:
    return np.asarray(x, np.float32).astype(np.float64)


def test_nothing_is_gained_or_lost() -> None:
    """White glass passes what it does not mirror, a gap all of it, metal-free matt nothing."""
    white = np.ones((3, 3))
    passed = passed_share(white, [0.0, 1.0, 1.0], [1.0, 1.0, 0.0], [0.04, 0.04, 0.04])
    np.testing.assert_allclose(passed, np.array([1.0, 0.96, 0.0])[:, None] * white)


def test_passed_share_is_its_twin(wgsl: Evaluate) -> None:
    base = single(RNG.uniform(0.0, 1.0, (COUNT, 3)))
    a, t, m = (single(RNG.uniform(0.0, 1.0, COUNT)) for _ in range(3))
    ours = wgsl("translucency", "passed_share", base, a, t, m, returns="vec3f")
    np.testing.assert_allclose(ours, passed_share(base, a, t, m), atol=3e-7)


def test_fresnel_is_its_twin(wgsl: Evaluate) -> None:
    f0, cosine = single(RNG.uniform(0.0, 0.08, COUNT)), single(RNG.uniform(0.0, 1.0, COUNT))
    ours = wgsl("translucency", "dielectric_fresnel", f0, cosine)
    np.testing.assert_allclose(ours, dielectric_fresnel(f0, cosine), atol=1e-6)
    np.testing.assert_allclose(dielectric_fresnel(0.04, [1.0, 0.0]), [0.04, 1.0])


def test_chance_is_its_twin(wgsl: Evaluate) -> None:
    texel = single(RNG.integers(0, 2048, (COUNT, 2)) + 0.5)
    plane = single(RNG.uniform(-20.0, 20.0, COUNT))
    apart = np.abs(wgsl("translucency", "chance", texel, plane) - chance(texel, plane))
    # The inner sum goes to 149, where float32 rounds by 2^-17; three roundings, times 53.
    assert np.minimum(apart, 1.0 - apart).max() < 3 * 53 * 2.0**-17


@pytest.mark.parametrize("share", [0.1, 0.5, 0.83])
def test_as_many_texels_are_there_as_should(share: float) -> None:
    """Of each 5 x 5 neighbours, within one of them all but everywhere, and exactly on the whole."""
    x, y = np.meshgrid(np.arange(100) + 0.5, np.arange(100) + 0.5)
    is_there = chance(np.stack([x, y], axis=-1), 0.3) < share
    assert is_there.mean() == pytest.approx(share, abs=0.003)
    blocks = is_there.reshape(20, 5, 20, 5).mean(axis=(1, 3))
    # Points drawn by lot would deviate by sqrt(share (1 - share) / 25).
    assert blocks.std() < 0.6 * np.sqrt(share * (1.0 - share) / 25.0)
