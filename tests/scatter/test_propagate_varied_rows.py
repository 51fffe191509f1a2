"""Steps through varying air whose lanes share rows are the plain kernel's, however it is cut."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.lanes import has_row_lanes
from airlight.gpu.memory import buffer_of
from airlight.scatter.propagate_varied import VariedStep
from airlight.scatter.propagate_varied_rows import is_whole_row, takes_rows


def test_rows_of_pairs_are_taken():
    assert takes_rows((32, 5, 4)) and is_whole_row((32, 5, 4))
    assert takes_rows((34, 5, 4)) and not is_whole_row((34, 5, 4))
    assert not takes_rows((5, 4, 4))


@pytest.mark.parametrize(
    ("count", "is_blocked", "is_track"),
    [((8, 4, 3), True, True), ((6, 3, 18), False, False), ((38, 3, 2), True, False)],
)
def test_every_cut_is_the_plain_step(gpu, commands, owned, count, is_blocked, is_track):
    if not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    rng, cells = np.random.default_rng(3), 3 * int(np.prod(count))
    sigma_t = 10.0 ** rng.uniform(-3, 1, cells)
    sigma_t[::7] = 0.0
    air = np.stack([rng.random(cells) * sigma_t, sigma_t], axis=-1).astype(np.float32)
    before, source = (
        owned(buffer_of(gpu, "state", rng.normal(size=(cells, 4)).astype(np.float32)))
        for _ in range(2)
    )
    medium = owned(buffer_of(gpu, "air", air))
    walls = rng.integers(0, 1 << 32, cells // 3 * 16, dtype=np.uint32)
    packs = owned(buffer_of(gpu, "packs", walls))
    found = []
    for has_rows in (False, True):
        after = owned(buffer_of(gpu, "after", np.full((cells, 4), np.nan, np.float32)))
        VariedStep(gpu, is_blocked=is_blocked, has_rows=has_rows).encode(
            commands,
            count,
            0.7,
            medium,
            is_track=is_track,
            before=before,
            source=source,
            after=after,
            packs=packs,
        )
        commands.submit()
        found.append(after.read())
    np.testing.assert_allclose(found[1], found[0], atol=2e-6 * np.abs(found[0]).max())
