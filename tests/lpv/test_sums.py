"""Sums of states, and what all later ones would add."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, buffer_of
from airlight.lpv.storage import FORMATS
from airlight.lpv.sums import Sums

pytestmark = pytest.mark.both_paths

CELLS = 300


def test_the_tail_is_a_geometric_series_per_channel(gpu, commands, owned):
    rng = np.random.default_rng(2)
    before = rng.random((3, CELLS, 4)).astype(np.float32)
    ratios = np.array([0.5, 0.25, 0.0], np.float32)
    last = before * ratios[:, None, None]
    sums = owned(Sums(gpu, CELLS, FORMATS["float32"], owned(Buffer(gpu, "range", 16))))
    total = owned(Buffer(gpu, "total", before.nbytes))
    block = owned(buffer_of(gpu, "last", last))
    sums.measure(commands, owned(buffer_of(gpu, "before", before)), 0)
    sums.measure(commands, block, 1)
    sums.add_to_total(commands, block, total, is_tail=True)
    commands.submit()
    expected = last * (ratios / (1.0 - ratios))[:, None, None]
    np.testing.assert_allclose(total.read().reshape(3, CELLS, 4), expected, rtol=1e-5)


def test_light_that_does_not_shrink_is_not_added_for_ever(gpu, commands, owned):
    light = np.ones((3, CELLS, 4), np.float32)
    block = owned(buffer_of(gpu, "block", light))
    sums = owned(Sums(gpu, CELLS, FORMATS["float32"], owned(Buffer(gpu, "range", 16))))
    total = owned(Buffer(gpu, "total", light.nbytes))
    sums.measure(commands, block, 0)
    sums.measure(commands, block, 1)
    sums.add_to_total(commands, block, total, is_tail=True)
    commands.submit()
    assert total.read().max() < 33.0


def test_half_floats_add_up_in_their_own_units(gpu, commands, owned):
    states = np.full((3, CELLS, 4), 2.0, np.float16)
    scale = owned(buffer_of(gpu, "range", np.array([4.0, 0, 0, 0], np.float32)))
    sums = owned(Sums(gpu, CELLS, FORMATS["float16"], scale))
    state = owned(buffer_of(gpu, "state", states))
    total = owned(Buffer(gpu, "total", 3 * CELLS * 16))
    sums.add_to_total(commands, state, total)
    sums.add_to_total(commands, state, total)
    commands.submit()
    assert np.unique(total.read()) == 1.0


@pytest.mark.parametrize("format", ["float32", "float16"])
def test_the_first_state_takes_the_place_of_what_was_there(gpu, commands, owned, format):
    dtype = np.dtype(format)
    states = np.full((2, 3, CELLS, 4), 2.0, dtype) * np.array([1, 3], dtype)[:, None, None, None]
    scale = owned(buffer_of(gpu, "range", np.ones(4, np.float32)))
    sums = owned(Sums(gpu, CELLS, FORMATS[format], scale))
    total = owned(buffer_of(gpu, "total", np.full(3 * CELLS * 4, 7.0, np.float32)))
    for index, state in enumerate(states):
        block = owned(buffer_of(gpu, "state", state))
        sums.add_to_total(commands, block, total, is_first=index == 0)
    commands.submit()
    np.testing.assert_array_equal(total.read(), np.full(3 * CELLS * 4, 8.0, np.float32))
