"""Steps whose lanes share a row are the plain kernel's, however the lattice is cut."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.lanes import Rows, has_row_lanes
from airlight.gpu.layout import pack_array
from airlight.gpu.memory import buffer_of
from airlight.scatter.coefficients import StepCoefficients, step_rows
from airlight.scatter.propagate import Step
from airlight.scatter.propagate_rows import rows_for

SIGMA_S, SIGMA_T = (0.05, 0.7, 2.0), (0.05, 0.8, 4.0)


def test_lattices_are_cut_to_whole_rows_where_they_fit():
    assert rows_for((32, 32, 32)) == Rows(4, 8, is_whole=True, is_ragged=False)
    assert rows_for((30, 18, 5)) == Rows(4, 6, is_whole=True, is_ragged=True)
    assert rows_for((64, 64, 64)) == Rows(8, 4, is_whole=True, is_ragged=False)
    assert rows_for((70, 2, 5)) == Rows(4, 2, is_whole=False, is_ragged=True)
    assert rows_for((31, 32, 32)) is None


@pytest.mark.parametrize("is_added", [True, False])
@pytest.mark.parametrize("count", [(8, 8, 3), (6, 5, 18), (2, 1, 1), (44, 3, 17), (70, 9, 2)])
def test_every_cut_is_the_plain_step(gpu, commands, owned, count, is_added):
    if not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    assert rows_for(count)
    rng = np.random.default_rng(3)
    shape = (3, *count[::-1], 4)
    before, source = (owned(buffer_of(gpu, "state", _floats(rng, shape))) for _ in range(2))
    given = buffer_of(gpu, "none", np.zeros(shape, np.float32)) if not is_added else source
    rows = buffer_of(gpu, "rows", pack_array(StepCoefficients, step_rows(SIGMA_S, SIGMA_T, 0.7)))
    found = []
    for is_marched in (False, True):
        after = owned(buffer_of(gpu, "after", np.full(shape, np.nan, np.float32)))
        # What is left out must not be read.
        left_out = source if is_marched else given
        Step(gpu, is_blocked=False, is_marched=is_marched).encode(
            commands,
            count,
            rows,
            0,
            before=before,
            source=left_out,
            after=after,
            packs=before,
            is_added=is_added,
        )
        commands.submit()
        found.append(after.read())
    np.testing.assert_allclose(found[1], found[0], atol=1e-6 * np.abs(found[0]).max())


def _floats(rng, shape):
    return rng.normal(size=shape).astype(np.float32)
