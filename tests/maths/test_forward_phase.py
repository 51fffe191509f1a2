"""Light scattered forwards and again: moments, sums of Henyey-Greenstein, the shader's twin."""

import numpy as np
import pytest

from airlight.maths.forward_phase import forward_phase, forward_scatterings
from airlight.maths.phase import ISOTROPIC, henyey_greenstein

MU = np.linspace(-1.0, 1.0, 40_001)


@pytest.mark.parametrize(
    ("g", "m"), [(-0.4, 1.0), (0.0, 3.0), (0.3, 1.2), (0.85, 2.0), (0.95, 4.0)]
)
def test_it_scatters_all_light_about_as_far_as_g_says(g, m):
    phase = forward_phase(MU, g, m)
    total = 2.0 * np.pi * np.trapezoid(phase, MU)
    # What is cut off below zero comes on top.
    assert 0.999 < total < 1.12
    mean = 2.0 * np.pi * np.trapezoid(phase * MU, MU) / total
    assert mean == pytest.approx(g, abs=0.07)
    assert phase.min() >= 0.0


def test_with_what_the_similar_medium_scattered_it_is_the_convolution():
    """Of m scatterings g^m went on forwards; those and the rest make HG(g^(m+1)) together."""
    g, m, mu = 0.9, 3, np.linspace(0.2, 1.0, 50)  # where nothing is cut off
    whole = g**m * forward_phase(mu, g, m) + (1.0 - g**m) * ISOTROPIC
    np.testing.assert_allclose(whole, henyey_greenstein(mu, g ** (m + 1)), rtol=1e-12)


def test_the_mean_number_of_scatterings_is_poissons():
    u, n = 1.7, np.arange(1, 60)
    shares = np.cumprod(u / n)
    assert forward_scatterings(u) == pytest.approx((shares @ n) / shares.sum(), rel=1e-12)
    assert forward_scatterings(0.0) == 1.0


def test_the_shader_says_the_same(wgsl):
    rng = np.random.default_rng(3)
    mu, g = rng.uniform(-1, 1, 2000), rng.uniform(-0.9, 0.95, 2000)
    m = rng.uniform(1.0, 8.0, 2000)
    mu, g, m = (v.astype(np.float32).astype(float) for v in (mu, g, m))
    got = wgsl("forward_phase", "forward_phase", mu, g, m)
    np.testing.assert_allclose(got, forward_phase(mu, g, m), rtol=2e-3, atol=3e-4)
    u = np.geomspace(1e-6, 50.0, 300).astype(np.float32).astype(float)
    got = wgsl("forward_phase", "forward_scatterings", u)
    np.testing.assert_allclose(got, forward_scatterings(u), rtol=1e-4)
