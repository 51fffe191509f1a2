"""Light scattered nearly straight on: sums over orders, limits, the shader's table."""

import numpy as np
import pytest

from airlight.maths.forward_phase import COSINES, DEPTHS, fused_phase, fused_table
from airlight.maths.phase import ISOTROPIC, henyey_greenstein

MU = 1.0 - 2.0 * np.linspace(0.0, 1.0, 4001) ** 3
CASES = [(0.3, 0.5), (0.7, 1.5), (0.9, 4.0), (0.95, 12.0)]


def _over_all_directions(phase):
    return -2.0 * np.pi * np.trapezoid(phase, MU)


@pytest.mark.parametrize(("g", "u"), CASES)
def test_all_light_with_one_bend_or_none_is_there(g, u):
    """Of k scatterings g^k go straight on, at any of k places; k g^(k-1) (1 - g) bend once."""
    never = (1.0 - (1.0 + g * u) * np.exp(-g * u)) / u
    once = (1.0 - g) * (1.0 - np.exp(-g * u))
    strayed = np.exp(-0.06 * ((1.0 - g) * u) ** 2)
    total = _over_all_directions(fused_phase(MU, g, u))
    assert total == pytest.approx(strayed * (never + once), rel=2e-3)


def test_in_thin_air_light_scatters_twice():
    """Half of u: each scattering may be the one at the place. What bends twice is the lattice's."""
    g, u = 0.8, 1e-4
    twice = henyey_greenstein(MU, g * g) - (1.0 - g) ** 2 * ISOTROPIC
    np.testing.assert_allclose(fused_phase(MU, g, u) / u, 0.5 * twice, rtol=1e-3)
    assert fused_phase(-1.0, g, u) > 0.0  # and backwards, too


def test_a_homogeneous_medium_has_none():
    np.testing.assert_allclose(fused_phase(MU, 0.0, 3.0), 0.0, atol=1e-12)
    assert not fused_table(0.0).any() and not fused_table(-0.5).any()


def test_tables_are_dense_enough():
    """Between rows and columns, as shaders read them."""
    g, table = 0.85, fused_table(0.85)
    assert table.shape == (DEPTHS, COSINES)
    rng = np.random.default_rng(2)
    mu, u = rng.uniform(-1.0, 1.0, 500), rng.uniform(0.0, 12.0, 500)
    x = (0.5 * (1.0 - mu)) ** 0.25 * (COSINES - 1)
    y = u / (1.0 + u) * (41.0 / 40.0) * (DEPTHS - 1)
    i, j = x.astype(int), y.astype(int)
    fx, fy = x - i, y - j
    exact = fused_phase(mu, g, u)
    rows = [(1.0 - fx) * table[r, i] + fx * table[r, i + 1] for r in (j, j + 1)]
    read = (1.0 - fy) * rows[0] + fy * rows[1]
    assert np.linalg.norm(read - exact) < 0.01 * np.linalg.norm(exact)
