"""The sum of many states by factors: (1 + M^4)(1 + M^2)(1 + M) s for eight.

As many steps as adding the source in each takes, but only those at a factor's end add, and those
between may be taken two at once. Right where a step is linear, and of use where one that adds
nothing, or two at once, cost less.
"""

from __future__ import annotations

from collections.abc import Callable

from ..gpu.memory import Buffer

Step = Callable[[Buffer, Buffer | None, Buffer, int], None]
"""(before, added, after, number): encodes after = added + M^number before."""


def summed_states(
    states: int,
    source: Buffer,
    sums: tuple[Buffer, Buffer],
    spare: tuple[Buffer, Buffer],
    step: Step,
    at_once: int = 1,
) -> Buffer:
    """source + M source + ... of so many `states`, in one of `sums` (or `source` where it is one).

    `spare` is overwritten, `source` is not. `step` takes `at_once` steps (1 or 2) at most.
    """
    total, held = source, 1
    for factor in ordered(states, at_once):
        later, numbers = total, taken(held, at_once)
        for turn in reversed(range(factor - 1)):
            for index, number in enumerate(numbers[:-1]):
                step(later, None, spare[index % 2], number)
                later = spare[index % 2]
            # The last turn ends in one of the sums; what a turn starts from it cannot overwrite.
            home = spare if len(numbers) == 1 and turn % 2 else sums
            target = next(b for b in home if b is not total and b is not later)
            step(later, total, target, numbers[-1])
            later = target
        total, held = later, held * factor
    return total


def taken(steps: int, at_once: int) -> list[int]:
    """So many steps as numbers of at most `at_once`, the smallest first."""
    whole, rest = divmod(steps, at_once)
    return [rest] * (rest > 0) + [at_once] * whole


def ordered(number: int, at_once: int) -> list[int]:
    """The prime factors in the order of least cost.

    Adding is cheapest where single steps do it, the largest factor first; but after an even one
    all that follows is taken two at once.
    """
    found = factors(number)
    return found if at_once == 1 else found[::-1]


def factors(number: int) -> list[int]:
    """The prime factors, largest first."""
    found, divisor = [], 2
    while number > 1:
        if number % divisor:
            divisor += 1
        else:
            number //= divisor
            found.append(divisor)
    return found[::-1]
