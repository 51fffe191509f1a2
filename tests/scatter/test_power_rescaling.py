"""Sums scaled by what they have lost."""

import numpy as np
import pytest

from airlight.scatter.level import LatticeKind, Level
from airlight.scatter.levels import Levels
from airlight.scatter.power_rescaling import PowerRescaling
from airlight.scatter.schedule import Schedule, schedule

from .test_levels import ALBEDO, COUNT, SIGMA_T, solved, sparks, summed  # type: ignore[import-not-found]


def rescaled(gpu, commands, lattice, source, current, stepped):
    """(what became of `current`, scales) where `stepped` is one step on."""
    level = Level(gpu, COUNT, 1.0, LatticeKind(has_walls=False, is_varied=False), is_finest=True)
    level.source, rescaling = lattice(source), PowerRescaling(gpu)
    out = lattice(current)
    rescaling.encode(commands, level, current=out, stepped=lattice(stepped))
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


def test_a_single_cycle_holds_nearly_all_light(gpu, commands, lattice):
    """White, thick air, which one cycle alone does not finish."""
    source = sparks()
    want = summed(100)[0, ..., 0].sum()
    rough = Schedule((1, 0), (1, 0), cycles=1)
    plans = rough, Schedule((1, 0), (1, 0), cycles=1, is_rescaled=True)
    alone, ours = (
        solved(gpu, commands, lattice, source, p, ALBEDO * SIGMA_T, SIGMA_T)[0, ..., 0].sum() / want
        for p in plans
    )
    assert alone < 0.9
    assert abs(ours - 1.0) < 0.5 * (1.0 - alone)


def test_only_cycles_and_regions_are_rescaled():
    assert schedule("cycle", 8, COUNT).is_rescaled
    assert schedule("regions", 8, COUNT).is_rescaled
    assert not schedule("none", 8, COUNT).is_rescaled
    assert not schedule("finish", 8, COUNT).is_rescaled


def test_a_lattice_in_the_dark_stays_dark(gpu, commands, lattice):
    levels = Levels(
        gpu, COUNT, 1.0, schedule("cycle", 8, COUNT), LatticeKind(has_walls=False, is_varied=False)
    )
    levels.set_homogeneous([1.0] * 3, [1.0] * 3)
    _, track = levels.encode(commands, lattice(0.0 * sparks()))
    commands.submit()
    assert not track.read().any()
