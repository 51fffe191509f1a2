"""Which kernel a lattice gets, and that a step adds what it is given."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import buffer_of
from airlight.lpv.step import CHANNELS, Step
from airlight.lpv.storage import FORMATS

pytestmark = pytest.mark.both_paths


@pytest.mark.parametrize("count", [(4, 3, 2), (5, 3, 2)])
@pytest.mark.parametrize("is_blocked", [False, True])
def test_what_is_added_comes_on_top(gpu, commands, owned, count, is_blocked):
    rng, cells = np.random.default_rng(2), int(np.prod(count))
    lattice = rng.normal(size=(CHANNELS, cells, 4)).astype(np.float32)
    before, more = (owned(buffer_of(gpu, "l", k * lattice)) for k in (1.0, 7.0))
    faces = owned(buffer_of(gpu, "f", rng.integers(0, 1 << 32, cells * 8, dtype=np.uint32)))
    found = []
    for added in (None, more):
        step = Step(
            gpu,
            count,
            "centroid",
            FORMATS["float32"],
            is_blocked=is_blocked,
            is_reflecting=is_blocked,
            kept=0.5,
            is_added=added is not None,
        )
        after = owned(buffer_of(gpu, "a", lattice))
        step.encode(commands, before, after, faces, added=added)
        commands.submit()
        found.append(after.read().reshape(lattice.shape))
    np.testing.assert_allclose(found[1] - found[0], 7.0 * lattice, atol=2e-5)
    assert np.abs(found[0]).max() > 0.1


def test_other_formats_are_not_read_as_pairs(gpu):
    step = Step(
        gpu,
        (4, 4, 4),
        "centroid",
        FORMATS["float16"],
        is_blocked=False,
        is_reflecting=False,
        kept=0.5,
    )
    assert step.element == "vec2u"
