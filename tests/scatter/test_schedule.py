"""Plans: how many steps; iterations that leave a given residual."""

import numpy as np
import pytest

from airlight.errors import SettingsError, SettingsWarning
from airlight.maths import lattice26
from airlight.scatter.schedule import iterations_to, schedule
from airlight.scatter.settings import ScatterSettings, iterations_of
from airlight.scene.settings import make_settings


def test_regions_are_corrected_after_the_first_step_and_every_third():
    plan = schedule("regions", 8)
    assert plan.by_regions
    assert [k for k in range(plan.steps) if plan.is_corrected(k)] == [0, 2, 5]


def test_the_first_state_is_an_iteration():
    plan = schedule("none", 5)
    assert (plan.steps, plan.by_regions, plan.is_empty) == (4, False, False)
    assert schedule("none", 0).is_empty


@pytest.mark.parametrize("former", ["finish", "cycle"])
def test_multigrid_cycles_are_taken_as_regions(former):
    with pytest.warns(SettingsWarning, match=f"'{former}' is no longer there, 'regions' is taken"):
        made = make_settings(ScatterSettings, {"acceleration": former})
    assert made.acceleration == "regions"


def test_an_unknown_acceleration_is_refused():
    with pytest.raises(SettingsError, match=r"acceleration = 'ones' is unknown\. Did you mean"):
        schedule("ones", 8)


@pytest.mark.parametrize(("sigma_t", "albedo"), [(0.1, 1.0), (0.5, 0.9), (1.0, 1.0), (3.0, 0.9)])
def test_after_the_iterations_about_the_residual_is_left(sigma_t, albedo):
    count = (9, 9, 9)
    needed = iterations_to(0.05, [albedo * sigma_t], [sigma_t], 1.0, count)
    state = np.zeros((1, *count, 4))
    state[0, 4, 4, 4, 0] = 1.0
    left = []
    for _ in range(needed):
        state, _ = lattice26.deposit_step(state, [sigma_t], [albedo], 1.0)
        left.append(state[..., 0].sum())
    assert left[-1] < 0.075
    # Nor are there many times more iterations than needed.
    assert needed <= 3.0 * np.searchsorted(-np.array(left), -0.05) + 3


def test_thicker_air_takes_longer():
    thin, thick = (iterations_to(0.05, [s] * 3, [s] * 3, 1.0, (16, 16, 16)) for s in (0.1, 3.0))
    assert thin < thick <= 512


def test_stills_take_more_iterations_unless_somebody_says_how_many():
    usual = ScatterSettings()
    assert [iterations_of(usual, is_still=still) for still in (False, True)] == [24, 48]
    few = ScatterSettings(still_iterations=20)
    assert [iterations_of(few, is_still=still) for still in (False, True)] == [24, 20]
    for asked in (ScatterSettings(iterations=5), ScatterSettings(iterations=5, residual=0.1)):
        assert iterations_of(asked, is_still=True) == 5
    assert iterations_of(ScatterSettings(residual=0.1), is_still=True) == 24
