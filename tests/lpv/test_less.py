"""One lattice less another."""

from __future__ import annotations

import numpy as np

from airlight.gpu.memory import Buffer, buffer_of
from airlight.lpv.less import Less


def test_the_remainder_is_the_difference(gpu, owned, commands):
    one, other = np.random.default_rng(1).random((2, 300, 4)).astype(np.float32)
    rest = owned(Buffer(gpu, "rest", one.nbytes))
    buffers = (owned(buffer_of(gpu, "light", values)) for values in (one, other))
    Less(gpu).encode(commands, *buffers, rest)
    commands.submit()
    np.testing.assert_array_equal(rest.read().reshape(-1, 4), one - other)
