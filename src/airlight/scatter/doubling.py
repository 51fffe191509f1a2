"""The sum of many states by factors: (1 + M^4)(1 + M^2)(1 + M) s for eight.

As many steps as adding the source in each takes, but only those at a factor's end add. Right where
a step is linear, and of use where one that adds nothing costs less.
"""

from __future__ import annotations

from collections.abc import Callable

from ..gpu.memory import Buffer

Step = Callable[[Buffer, Buffer | None, Buffer], None]
"""(before, added, after): encodes after = added + M before."""


def summed_states(
    states: int, source: Buffer, sums: tuple[Buffer, Buffer], spare: tuple[Buffer, Buffer],
    step: Step,
) -> Buffer:  # fmt: skip
    """source + M source + ... of so many `states`, in one of `sums` (or `source` where it is one).

    `spare` is overwritten, `source` is not.
    """
    total, held = source, 1
    for factor in factors(states):
        later = total
        for _ in range(factor - 1):
            for index in range(held - 1):
                step(later, None, spare[index % 2])
                later = spare[index % 2]
            # Where the source is the total, both sums are free, and else the one that is not.
            used = later if held == 1 else total
            target = sums[1] if used is sums[0] else sums[0]
            step(later, total, target)
            later = target
        total, held = later, held * factor
    return total


def factors(number: int) -> list[int]:
    """The prime factors, largest first: adding is cheapest where single steps do it."""
    found, divisor = [], 2
    while number > 1:
        if number % divisor:
            divisor += 1
        else:
            number //= divisor
            found.append(divisor)
    return found[::-1]
