"""Steps among walls are the plain kernel's, in columns and in lanes that share rows."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.lanes import has_row_lanes
from airlight.gpu.layout import pack_array
from airlight.gpu.memory import buffer_of
from airlight.scatter import propagate
from airlight.scatter.coefficients import StepCoefficients, step_rows
from airlight.scatter.propagate import Step

SIGMA_S, SIGMA_T = (0.05, 0.7, 2.0), (0.05, 0.8, 4.0)


@pytest.mark.parametrize(("count", "has_rows"), [((34, 3, 9), True), ((6, 4, 10), False)])
def test_every_kernel_is_the_plain_step(gpu, commands, owned, monkeypatch, count, has_rows):
    if has_rows and not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    monkeypatch.setattr(propagate, "has_row_lanes", lambda _: has_rows)
    rng, cells = np.random.default_rng(3), int(np.prod(count))
    shape = (3, cells, 4)
    before, source = (
        owned(buffer_of(gpu, "state", rng.normal(size=shape).astype(np.float32))) for _ in range(2)
    )
    packs = owned(buffer_of(gpu, "packs", rng.integers(0, 1 << 32, cells * 16, dtype=np.uint32)))
    rows = owned(
        buffer_of(gpu, "rows", pack_array(StepCoefficients, step_rows(SIGMA_S, SIGMA_T, 0.7)))
    )
    found = []
    for is_marched in (False, True):
        after = owned(buffer_of(gpu, "after", np.full(shape, np.nan, np.float32)))
        Step(gpu, is_blocked=True, is_marched=is_marched).encode(
            commands, count, rows, 0, before=before, source=source, after=after, packs=packs
        )
        commands.submit()
        found.append(after.read())
    np.testing.assert_allclose(found[1], found[0], atol=1e-6 * np.abs(found[0]).max())
