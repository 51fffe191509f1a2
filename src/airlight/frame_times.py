"""How long the frames of a renderer took, for --stats."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from time import perf_counter

# Frames that medians are taken of.
_MOST_TIMES = 256


class FrameTimes:
    """`frame_ms` from a frame's call to its image, `python_ms` of that until all was submitted.

    Of a long animation the lists hold the first frame and the latest ones. `first_image_s` counts
    from the beginning, with all that is made and compiled for the first image; None before it.
    """

    def __init__(self) -> None:
        self._began_s = perf_counter()
        self.frame_ms: list[float] = []
        self.python_ms: list[float] = []
        self.first_image_s: float | None = None

    def add(self, begin: float, encoded: float, done: float) -> None:
        """Take the moments of a frame, seconds of `perf_counter`."""
        if self.first_image_s is None:
            self.first_image_s = done - self._began_s
        # The first frame is kept, as the only one that compiled shaders.
        for stored, spent_s in ((self.frame_ms, done - begin), (self.python_ms, encoded - begin)):
            del stored[1:-_MOST_TIMES]
            stored.append(spent_s * 1e3)

    def forget_last(self) -> None:
        """Leave out the last frame, of which something else was measured."""
        self.frame_ms.pop()
        self.python_ms.pop()

    @property
    def stats(self) -> dict[str, float | None]:
        """Medians of the frames after the first, which compiles shaders; None before a second."""
        return {
            "frame_ms": _median(self.frame_ms[1:]),
            "python_ms": _median(self.python_ms[1:]),
            "first_image_s": self.first_image_s,
        }


def _median(times_ms: Sequence[float]) -> float | None:
    return statistics.median(times_ms) if times_ms else None
