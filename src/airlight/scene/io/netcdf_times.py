"""One of the times of a variable: by its number behind the name, or the first that holds any."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from .dense_grid import check_count

_NUMBERED = re.compile(r"(.+)\[(-?\d{1,9})\]")


def name_and_number(wanted: str, names: list[str]) -> tuple[str, int | None]:
    """A grid's name and the number of its time: "ql[3]" is the fourth, "ql[-1]" the last.

    None without a number, and where a variable has that very name.
    """
    found = _NUMBERED.fullmatch(wanted)
    if found is None or wanted in names:
        return wanted, None
    return found[1], int(found[2])


def at_one_time(
    variable: Any, axis: str | None, number: int | None, shown: int | None, file: str
) -> tuple[Any, int, tuple[str, ...]]:
    """The variable without its dimension `axis`, which of its times that is, and what to tell.

    `axis` None: it has no times. `number` counts from 0, below 0 from the end; of None it is the
    time `shown` of the grid that this one lies beside, unless it is static: has one time, or none.
    Of None, too, it is the first time with any value above 0, else the first. Raises SceneError for
    a number out of range, and for more values than can be used.
    """
    count = 1 if axis is None else int(variable.sizes[axis])
    if count == 0:
        raise SceneError(f"has no times of '{variable.name}' yet")
    if number is not None and not -count <= number < count:
        have = "one time" if count == 1 else f"{count} times, 0 to {count - 1}"
        raise SceneError(f"has no '{variable.name}[{number}]': it has {have}")
    if axis is None:
        return variable, 0, ()
    # Beside another grid it is that one's time, or the two would show different moments.
    if number is None and shown is not None and count > 1:
        number = shown
        if shown >= count:
            raise SceneError(
                f"has {count} times of '{variable.name}', but number {shown} is shown",
                remedy=f'"{variable.name}[-1]" takes the last.',
            )
    if number is not None:
        return variable.isel({axis: number}), number % count, ()
    # Simulations of clouds begin in clear air. Only one time is in memory at once.
    check_count(variable.size // max(count, 1))
    chosen = next((k for k in range(count) if _holds_any(variable.isel({axis: k}))), 0)
    found = variable.isel({axis: chosen})
    if count == 1:
        return found, 0, ()
    which = f"number {chosen} is read, the first that holds any" if chosen else "the first is read"
    how = f'--grid "{variable.name}[-1]", in a [[volume]] grid, takes the last'
    text = f"{file} has {count} times, {which} ({how}; airlight info lists them)"
    return found, chosen, (text, *_unevenly(variable, axis, file))


def _unevenly(variable: Any, axis: str, file: str) -> tuple[str, ...]:
    """What to tell of times that are not evenly spaced: a sequence shows them evenly."""
    times = variable.coords.get(axis)
    if times is None or times.ndim != 1 or times.dtype.kind not in "fiu" or times.size < 3:
        return ()
    return uneven(np.asarray(times.values, np.float64), f"{file}: '{axis}'")


def uneven(times: NDArray[np.float64], what: str) -> tuple[str, ...]:
    """What to tell of `times` that are not evenly spaced: a sequence shows them evenly."""
    steps = np.diff(times)
    if len(steps) < 2 or np.ptp(steps) <= 0.01 * abs(float(steps.mean())):
        return ()
    return (f"{what} is not evenly spaced: a sequence shows its times evenly",)


def _holds_any(variable: Any) -> bool:
    # Missing values are not above 0.
    return bool((np.asarray(variable.values) > 0).any())
