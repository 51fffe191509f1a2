"""Tables of what a part of the sky scatters, against quadrature over cones and their norm."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import dblquad

from airlight.maths.beam_phase import beam_phase, beam_phase_table
from airlight.maths.phase import henyey_greenstein

MU = np.linspace(-1.0, 1.0, 200_001)


@pytest.mark.parametrize("g", [-0.4, 0.0, 0.7, 0.9, 0.99])
@pytest.mark.parametrize("cosine", [1.0, 0.984, 0.9])
def test_a_table_integrates_to_one(g, cosine):
    table = beam_phase_table([g], [cosine])[0]
    phase = beam_phase(table, MU)[:, 0]
    assert 2.0 * np.pi * np.trapezoid(phase, MU) == pytest.approx(1.0, abs=0.01)
    assert phase.min() >= 0.0


def over_cone(mu, g, c):
    """Henyey-Greenstein averaged over the cone of mean cosine c, by quadrature."""
    s = np.sqrt(1.0 - mu * mu)

    def over(phi, m):
        angle = mu * m + s * np.sqrt(1.0 - m * m) * np.cos(phi)
        return float(henyey_greenstein(angle, g))

    value, _ = dblquad(over, 2.0 * c - 1.0, 1.0, 0.0, np.pi, epsabs=1e-7, epsrel=1e-5)
    return value / (2.0 * np.pi * (1.0 - c))


def test_a_strong_lobe_is_averaged_over_its_cone():
    c, g = 0.984, 0.95
    mu = np.linspace(-1.0, 1.0, 8)
    got = beam_phase(beam_phase_table([g], [c])[0], mu)[:, 0]
    want = [over_cone(m, g, c) for m in mu]
    np.testing.assert_allclose(got, want, rtol=0.03)
    # Its peak is lower than that of g c, its flank higher: no spots.
    assert got[-1] < henyey_greenstein(1.0, g)


def test_a_point_and_weak_lobes_are_plain():
    mu = np.linspace(-1.0, 1.0, 40)
    table = beam_phase_table([0.95, 0.5], [1.0, 0.9])
    np.testing.assert_allclose(
        beam_phase(table[0], mu)[:, 0], henyey_greenstein(mu, 0.95), rtol=0.02
    )
    np.testing.assert_allclose(
        beam_phase(table[1], mu)[:, 1], henyey_greenstein(mu, 0.45), rtol=0.01
    )
    off = beam_phase_table([0.95], [0.9], prefilter=False)[0]
    np.testing.assert_allclose(
        beam_phase(off, mu)[:, 0], henyey_greenstein(mu, 0.95 * 0.9), rtol=0.01
    )
