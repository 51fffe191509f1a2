"""Steps whose lanes share rows are the plain kernel's, however the lattice is cut."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.lanes import has_row_lanes
from airlight.gpu.layout import pack_array
from airlight.gpu.memory import buffer_of
from airlight.scatter.coefficients import StepCoefficients, step_rows
from airlight.scatter.propagate import Operator, Step, StepMedium, tiles

SIGMA_S, SIGMA_T = (0.05, 0.7, 2.0), (0.05, 0.8, 4.0)


def test_every_processor_has_tiles_and_no_slab_is_thin():
    assert tiles((32, 32, 32), 2) == (8, 16, 1)
    assert tiles((32, 4, 32), 2) == (8, 2, 2)
    assert tiles((32, 4, 32), 64) == (8, 2, 4)
    assert tiles((6, 3, 5), 64) == (2, 2, 1)


@pytest.mark.parametrize("operator", [Operator.MOVE, Operator.TRACK])
@pytest.mark.parametrize("is_varied", [False, True], ids=["homogeneous", "varied"])
@pytest.mark.parametrize("has_walls", [False, True], ids=["open", "walls"])
@pytest.mark.parametrize("count", [(6, 5, 18), (2, 1, 1), (44, 3, 17), (70, 9, 2)])
def test_every_cut_is_the_plain_step(gpu, commands, owned, count, has_walls, is_varied, operator):
    if not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    rng, cells = np.random.default_rng(3), int(np.prod(count))
    shape = (3, cells, 4)
    before, source = (
        owned(buffer_of(gpu, "state", rng.normal(size=shape).astype(np.float32))) for _ in range(2)
    )
    medium = owned(buffer_of(gpu, "medium", rng.random((3, cells, 2)).astype(np.float32)))
    packs = owned(buffer_of(gpu, "packs", rng.integers(0, 1 << 32, cells * 16, dtype=np.uint32)))
    rows = owned(
        buffer_of(gpu, "rows", pack_array(StepCoefficients, step_rows(SIGMA_S, SIGMA_T, 0.7)))
    )
    lattice = StepMedium(count, 0.7, medium, rows, packs)
    found = []
    for has_rows in (False, True):
        after = owned(buffer_of(gpu, "after", np.full(shape, np.nan, np.float32)))
        step = Step(gpu, has_walls=has_walls, is_varied=is_varied, has_rows=has_rows)
        step.encode(commands, lattice, operator, before=before, source=source, after=after)
        commands.submit()
        found.append(after.read())
    # The same sums; compilers contract multiplications and additions as they like.
    np.testing.assert_allclose(found[1], found[0], atol=1e-6 * np.abs(found[0]).max())
