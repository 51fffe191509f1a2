"""Sums by factors, with numbers for lattices and a number for a step."""

from __future__ import annotations

import math

import pytest

from airlight.scatter.doubling import factors, ordered, summed_states, taken

M = 0.75


class Lattice:
    """One number in place of a buffer."""

    value = math.nan


@pytest.mark.parametrize("at_once", [1, 2])
@pytest.mark.parametrize("states", range(1, 31))
def test_it_is_the_geometric_series_in_as_many_steps(states, at_once):
    source, *others = (Lattice() for _ in range(5))
    source.value = 2.0
    added, numbers = [], []

    def step(before, more, after, number):
        assert after is not before and after is not more and after is not source
        assert 1 <= number <= at_once
        after.value = M**number * before.value + (more.value if more else 0.0)
        added.append(more is not None)
        numbers.append(number)

    found = summed_states(states, source, tuple(others[:2]), tuple(others[2:]), step, at_once)
    assert found in ([source] if states == 1 else others[:2])
    assert found.value == pytest.approx(2.0 * sum(M**k for k in range(states)))
    assert sum(numbers) == states - 1
    assert sum(added) == sum(p - 1 for p in factors(states))


def test_eight_states_add_three_times():
    assert factors(8) == [2, 2, 2]
    assert factors(12) == [3, 2, 2]
    assert factors(1) == []


def test_an_even_number_of_states_takes_one_single_step():
    assert ordered(12, 1) == [3, 2, 2]
    assert ordered(12, 2) == [2, 2, 3]
    assert taken(5, 2) == [1, 2, 2]
    assert taken(3, 1) == [1, 1, 1]
