"""Henyey-Greenstein: normalisation, moments, limits, sampling, caps, cones."""

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from airlight.maths import phase

G = [-0.999, -0.7, -1e-9, 0.0, 1e-9, 0.3, 0.85, 0.999]


@pytest.mark.parametrize("g", G)
def test_normalised_with_mean_cosine_g(g: float) -> None:
    peak = [np.sign(g) * p for p in (0.9, 0.999, 0.99999)] if g else None

    def moment(k: int) -> float:
        value, _ = quad(
            lambda mu: 2.0 * np.pi * mu**k * float(phase.henyey_greenstein(mu, g)),
            -1, 1, points=peak, limit=400,
        )  # fmt: skip
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
            lambda m: 2.0 * np.pi * float(phase.henyey_greenstein(m, g)), -1.0, mu,
            points=inner or None, limit=400,
        )  # fmt: skip
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


@pytest.mark.parametrize("g", G)
def test_sampling_inverts_the_cumulative(g: float) -> None:
    u = np.linspace(0.0, 1.0, 101)
    mu = phase.sample_henyey_greenstein(u, g)
    np.testing.assert_allclose(phase.henyey_greenstein_cumulative(mu, g), u, atol=1e-9)


def test_two_scatterings_are_one_of_the_product() -> None:
    # the mean cosine of two independent turns is the product of theirs
    rng = np.random.default_rng(4)
    a, b = (phase.sample_henyey_greenstein(rng.random(200_000), g) for g in (0.8, 0.5))
    turn = np.cos(2.0 * np.pi * rng.random(a.size))
    mu = a * b + np.sqrt((1 - a * a) * (1 - b * b)) * turn
    g = float(phase.convolved_anisotropy(0.8, 0.5))
    assert g == 0.4
    expected = phase.henyey_greenstein_cumulative(np.linspace(-1, 1, 21), g)
    measured = np.searchsorted(np.sort(mu), np.linspace(-1, 1, 21)) / mu.size
    np.testing.assert_allclose(measured, expected, atol=4.0 * 0.5 / np.sqrt(mu.size))


@pytest.mark.parametrize(("g", "omega"), [(0.9, 0.2), (0.98, 0.05), (-0.6, 1.0)])
def test_cone_average_against_quadrature(g: float, omega: float) -> None:
    cosine = 1.0 - omega / (2.0 * np.pi)
    for mu in (1.0, 0.97, 0.5, -1.0):
        s = np.sqrt(1.0 - mu * mu)

        def over(phi: float, m: float, mu: float = mu, s: float = s) -> float:
            angle = mu * m + s * np.sqrt(1.0 - m * m) * np.cos(phi)
            return float(phase.henyey_greenstein(angle, g))

        value, _ = dblquad(over, cosine, 1.0, 0.0, np.pi, epsabs=1e-9, epsrel=1e-7)
        average = phase.henyey_greenstein_over_cone(mu, g, omega)
        assert float(average) == pytest.approx(2.0 * value / omega, rel=1e-5, abs=1e-9)


def test_cone_average_of_a_point_is_the_lobe_itself() -> None:
    mu = np.linspace(-1, 1, 7)
    np.testing.assert_allclose(
        phase.henyey_greenstein_over_cone(mu, 0.9, 0.0), phase.henyey_greenstein(mu, 0.9)
    )


def test_cone_table_looked_up_linearly() -> None:
    table = phase.cone_phase_table(0.95, 0.2)
    mu = np.linspace(-1.0, 1.0, 5001)
    read = np.interp(np.sqrt((1.0 - mu) / 2.0), np.linspace(0.0, 1.0, len(table)), table)
    exact = phase.henyey_greenstein_over_cone(mu, 0.95, 0.2)
    assert np.abs(read - exact).max() < 4e-3 * exact.max()
    assert 2.0 * np.pi * np.trapezoid(read, mu) == pytest.approx(1.0, abs=2e-3)
