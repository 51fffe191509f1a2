"""Sums by factors, with numbers for lattices and a number for a step."""

from __future__ import annotations

import math

import pytest

from airlight.scatter.doubling import factors, summed_states

M = 0.75


class Lattice:
    """One number in place of a buffer."""

    value = math.nan


@pytest.mark.parametrize("states", range(1, 20))
def test_it_is_the_geometric_series_in_as_many_steps(states):
    source, *others = (Lattice() for _ in range(5))
    source.value = 2.0
    added = []

    def step(before, more, after):
        assert after is not before and after is not more and after is not source
        after.value = M * before.value + (more.value if more else 0.0)
        added.append(more is not None)

    found = summed_states(states, source, tuple(others[:2]), tuple(others[2:]), step)
    assert found in ([source] if states == 1 else others[:2])
    assert found.value == pytest.approx(2.0 * sum(M**k for k in range(states)))
    assert len(added) == states - 1
    assert sum(added) == sum(p - 1 for p in factors(states))


def test_eight_states_add_three_times():
    assert factors(8) == [2, 2, 2]
    assert factors(12) == [3, 2, 2]
    assert factors(1) == []
