"""Henyey-Greenstein: normalisation, moments, limits, caps."""

import numpy as np
import pytest
from scipy.integrate import quad

from airlight.maths import phase

G = [-0.999, -0.7, -1e-9, 0.0, 1e-9, 0.3, 0.85, 0.999]


@pytest.mark.parametrize("g", G)
def test_normalised_with_mean_cosine_g(g: float) -> None:
    peak = [np.sign(g) * p for p in (0.9, 0.999, 0.99999)] if g else None

    def moment(k: int) -> float:
        value, _ = quad(
            lambda mu: 2.0 * np.pi * mu**k * float(phase.henyey_greenstein(mu, g)),
            -1,
            1,
            points=peak,
            limit=400,
        )
        return value

    assert moment(0) == pytest.approx(1.0, abs=1e-8)
    assert moment(1) == pytest.approx(g, abs=1e-8)


def test_isotropic_limit() -> None:
    mu = np.linspace(-1, 1, 9)
    np.testing.assert_allclose(phase.henyey_greenstein(mu, 0.0), phase.isotropic(mu))
    np.testing.assert_allclose(phase.isotropic(mu), 1.0 / (4.0 * np.pi))


def test_peak_of_a_sharp_lobe_keeps_its_digits() -> None:
    h = 1e-9  # 1 - |g|: at the peak f = (1+|g|)/(4 pi (1-|g|)^2)
    expected = (2.0 - h) / (4.0 * np.pi * h * h)
    peaks = phase.henyey_greenstein([1.0, -1.0], [1.0 - h, -1.0 + h])
    np.testing.assert_allclose(peaks, expected, rtol=1e-6)


@pytest.mark.parametrize("g", G)
def test_cumulative_is_the_integral(g: float) -> None:
    for mu in (-1.0, -0.3, 0.5, 0.99, 1.0):
        inner = [s * p for p in (0.9, 0.999, 0.99999) for s in (-1, 1) if s * p < mu]
        value, _ = quad(
            lambda m: 2.0 * np.pi * float(phase.henyey_greenstein(m, g)),
            -1.0,
            mu,
            points=inner or None,
            limit=400,
        )
        assert float(phase.henyey_greenstein_cumulative(mu, g)) == pytest.approx(value, abs=1e-8)


def test_cumulative_holds_up_to_deltas() -> None:
    np.testing.assert_allclose(
        phase.henyey_greenstein_cumulative([-1.0, 0.3, 1.0], 1.0), [0.0, 0.0, 1.0]
    )
    np.testing.assert_allclose(phase.henyey_greenstein_cumulative([-0.9, 1.0], -1.0), 1.0)


def test_cap_fractions_sum_to_one() -> None:
    g = np.linspace(-1.0, 1.0, 2001)
    front, side, back = phase.cap_fractions(g)
    np.testing.assert_allclose(front + 4.0 * side + back, 1.0, rtol=0, atol=2.3e-16)
    assert min(front.min(), side.min(), back.min()) > -1e-15
    # a cap of 45 degrees is (1 - cos 45)/2 of the sphere
    np.testing.assert_allclose(
        [f[1000] for f in (front, back)], 0.5 * (1.0 - np.sqrt(0.5)), rtol=1e-12
    )
