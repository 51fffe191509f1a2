"""A value that changes with time, by keyframes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import SceneError
from ...maths import keyframes
from ..checks import F64

BETWEEN: dict[str, Callable[[F64, F64, float], F64]] = {
    "step": keyframes.step,
    "linear": keyframes.linear,
    "smooth": keyframes.smooth,
    "slerp": keyframes.slerp,
    "cubic": keyframes.cubic_spline,
    "cubic-rotation": lambda t, v, x: keyframes.unit_quaternion(keyframes.cubic_spline(t, v, x)),
}
"""How values between keyframes are made."""


@dataclass(frozen=True, eq=False)
class Curve:
    """`values` (K, C) at `times` (K,), seconds, strictly rising; "cubic" has (K, 3, C).

    `between` is one of BETWEEN. Before the first and after the last keyframe their values hold.
    Raises SceneError for times that do not rise.
    """

    times: F64
    values: F64
    between: str = "smooth"

    def __post_init__(self) -> None:
        times = np.array(self.times, dtype=np.float64)
        values = np.array(self.values, dtype=np.float64)
        # As many times as values, one at least, all finite and rising.
        if times.ndim != 1 or len(times) == 0 or len(times) != len(values):
            raise SceneError(f"{len(values)} keyframes have {times.size} times")
        if not (np.isfinite(times).all() and np.isfinite(values).all()):
            raise SceneError("a keyframe is NaN or infinite")
        if (np.diff(times) <= 0.0).any():
            late = int(np.argmax(np.diff(times) <= 0.0))
            raise SceneError(
                f"keyframe times must rise, but {times[late + 1]:g} s comes after {times[late]:g} s"
            )
        # A curve is a value: nobody changes its keyframes afterwards.
        times.flags.writeable = values.flags.writeable = False
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    def at(self, time_s: float) -> F64:
        """The value (C,) at a time."""
        if self.between == "smooth":
            return keyframes.smooth(self.times, self.values, time_s, self._speeds)
        return BETWEEN[self.between](self.times, self.values, time_s)

    @cached_property
    def _speeds(self) -> F64 | None:
        has_two = len(self.times) > 1
        return keyframes.catmull_rom_speeds(self.times, self.values) if has_two else None

    @property
    def end_s(self) -> float:
        """The last keyframe's time."""
        return float(self.times[-1])
