"""Numbers of a step: what energy does, and the paper's equation 3."""

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.maths import lattice26
from airlight.scatter.coefficients import paper_rows, step_rows

COUNTS = np.array([6.0, 12.0, 8.0])


def isotropic_gain(row):
    """What a step makes of isotropic power, its own deposit included."""
    return COUNTS @ (row["arriving"] + row["kept"])


@pytest.mark.parametrize("sigma_t", [0.0, 1e-4, 0.3, 10.0])
def test_power_is_kept_without_absorption_and_lost_with_it(sigma_t):
    move = step_rows([sigma_t] * 3, [sigma_t] * 3, 1.0)[0]
    assert isotropic_gain(move) == pytest.approx(1.0, rel=1e-12)
    absorbing = step_rows([0.0] * 3, [sigma_t] * 3, 1.0)[0]
    h = lattice26.hops()
    assert isotropic_gain(absorbing) == pytest.approx(h.weights @ np.exp(-sigma_t * h.lengths))


def test_walls_reflect_all_that_is_not_absorbed():
    """At reflectance and albedo 1, stopped and returned light is what was stopped."""
    row = step_rows([0.7] * 3, [0.7] * 3, 1.3)[0]
    total = row["stopped"] + row["returned"]
    np.testing.assert_allclose(total, lattice26.hops().weights[[0, 6, 18]], rtol=1e-12)


def test_equation_3_as_printed_hands_on_0_699_of_what_scatters():
    s = 0.1
    printed, fixed = (paper_rows([s] * 3, [s] * 3, 1.0, is_gamma_fixed=f)[0] for f in (False, True))
    depth = s * lattice26.mean_hop_length()
    scattered = [row["gain"][0] - (1.0 - depth) for row in (printed, fixed)]
    assert scattered[0] / scattered[1] == pytest.approx(0.6991, abs=1e-4)
    assert fixed["gain"][0] == pytest.approx(1.0)
    assert COUNTS @ printed["arriving"] == pytest.approx(1.0)


def test_equation_3_is_refused_where_it_is_unstable():
    with pytest.raises(
        SettingsError,
        match=r"needs less than 1 mean free path per hop, here are "
        r"1\.36\. Raise the resolution, thin the medium",
    ):
        paper_rows([1.0] * 3, [1.0, 0.1, 0.1], 1.0)
