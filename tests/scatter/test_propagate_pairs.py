"""Two steps at once are two single ones, to the same bits, however the lattice is cut."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.lanes import Rows, has_row_lanes
from airlight.gpu.layout import pack_array
from airlight.gpu.memory import buffer_of
from airlight.scatter.coefficients import StepCoefficients, step_rows
from airlight.scatter.propagate import Step
from airlight.scatter.propagate_pairs import pairs_for

SIGMA_S, SIGMA_T = (0.05, 0.7, 2.0), (0.05, 0.8, 4.0)


def test_lattices_whose_rows_lanes_hold_are_cut():
    assert pairs_for((32, 32, 32)) == Rows(4, 8, is_whole=True, is_ragged=False)
    assert pairs_for((30, 18, 5)) == Rows(4, 6, is_whole=True, is_ragged=True)
    assert pairs_for((64, 64, 64)) == Rows(8, 4, is_whole=True, is_ragged=False)
    assert pairs_for((70, 64, 64)) is None
    assert pairs_for((31, 32, 32)) is None


@pytest.mark.parametrize(
    ("count", "is_added"), [((8, 8, 3), False), ((6, 3, 19), True), ((44, 3, 5), False)]
)
def test_every_cut_is_two_single_steps(gpu, commands, owned, count, is_added):
    if not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    rng = np.random.default_rng(3)
    shape = (3, *count[::-1], 4)
    before, source = (
        owned(buffer_of(gpu, "state", rng.normal(size=shape).astype(np.float32))) for _ in range(2)
    )
    rows = owned(
        buffer_of(gpu, "rows", pack_array(StepCoefficients, step_rows(SIGMA_S, SIGMA_T, 0.7)))
    )
    step, found = Step(gpu, is_blocked=False), []
    assert step.at_once(count) == 2

    def after(given, *, is_added, steps=1):
        target = owned(buffer_of(gpu, "after", np.full(shape, np.nan, np.float32)))
        step.encode(
            commands,
            count,
            rows,
            0,
            before=given,
            source=source,
            after=target,
            packs=before,
            is_added=is_added,
            steps=steps,
        )
        commands.submit()
        found.append(target.read())
        return target

    after(after(before, is_added=False), is_added=is_added)
    after(before, is_added=is_added, steps=2)
    np.testing.assert_array_equal(found[2], found[1])
