"""Sums scaled by what they have lost."""

import numpy as np
import pytest

from airlight.scatter.power_rescaling import PowerRescaling
from airlight.scatter.schedule import schedule
from airlight.scatter.state_sum import LatticeKind, StateSum

from .test_state_sum import COUNT, sparks  # type: ignore[import-not-found]


def rescaled(gpu, commands, lattice, source, current, stepped):
    """(what became of `current`, scales) where `stepped` is one step on."""
    out, rescaling = lattice(current), PowerRescaling(gpu)
    rescaling.encode(commands, COUNT, lattice(source), current=out, stepped=lattice(stepped))
    commands.submit()
    return out.read().reshape(source.shape), rescaling.scales.read()[:3]


def test_light_lost_by_halves_is_doubled_less_what_came_in(gpu, commands, lattice):
    """M = 1/2: the sum of 1 + 1/2 + ... is 2, whatever of it is known."""
    source = sparks()
    known = np.array([1.0, 1.5, 1.875]).reshape(3, 1, 1, 1, 1) * source
    got, scales = rescaled(gpu, commands, lattice, source, known, source + 0.5 * known)
    np.testing.assert_allclose(scales, [2.0, 4 / 3, 16 / 15], rtol=1e-5)
    np.testing.assert_allclose(got, 2.0 * source, rtol=1e-5)


@pytest.mark.parametrize("source", [0.0, 1.0])
def test_neither_darkness_nor_light_that_nothing_takes_out_grows_without_end(
    gpu, commands, lattice, source
):
    light = source * sparks()
    got, scales = rescaled(gpu, commands, lattice, light, light, 2.0 * light)
    np.testing.assert_allclose(scales, 2.0 if source else 1.0)
    np.testing.assert_allclose(got, 3.0 * light, rtol=1e-6)


def test_a_lattice_in_the_dark_stays_dark(gpu, commands, lattice):
    states = StateSum(
        gpu, COUNT, 1.0, schedule("regions", 8), LatticeKind(has_walls=False, is_varied=False)
    )
    states.set_homogeneous([1.0] * 3, [1.0] * 3)
    _, track = states.encode(commands, lattice(0.0 * sparks()))
    commands.submit()
    assert not track.read().any()
