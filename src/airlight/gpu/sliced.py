"""Commands for work in the background of a viewer: pass by pass, long ones in bands, between its
frames.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from .bands import Pace
from .commands import Commands
from .device import Gpu


class SlicedCommands(Commands):
    """Submits each band of a pass by itself and waits for it; the results are the same bits.

    `turn` makes a context in which a band is submitted and waited for. An exception from it, which
    stops the work, goes through whatever is encoding; that can then only be released.
    """

    is_recordable = False

    def __init__(self, gpu: Gpu, turn: Callable[[], AbstractContextManager[Any]]) -> None:
        super().__init__(gpu)
        self._turn, self._pace = turn, Pace()
        self.wanted: Callable[[], bool] = lambda: True
        """Whether what is encoded now is still to be seen."""
        self._spent_s = 0.0  # on the device, by what was submitted last

    @property
    def is_wanted(self) -> bool:
        """As `wanted` says."""
        return self.wanted()

    @property
    def compute(self) -> Any:
        """A compute pass for one dispatch."""
        self.submit()
        return super().compute

    @contextmanager
    def render(self, label: str, **attachments: Any) -> Iterator[Any]:
        """A render pass onto the given attachments."""
        self.submit()
        with super().render(label, **attachments) as encoder:
            yield encoder

    def bands(self, key: Hashable, count: int, layer: int = 1) -> Iterator[tuple[int, int]]:
        """The bands of a pass, each submitted once it is encoded, as large as those before say."""
        first = 0

        # Each band is submitted and timed before the next one's size is known.
        while first < count:
            size = self._pace.next(key, first, count, layer)
            yield first, size
            self.submit()
            self._pace.took(key, size, self._spent_s)
            first += size

    def submit(self) -> None:
        """Hand over what is encoded, and wait for it."""
        if self._encoder is None:
            return
        with self._turn():
            begin = time.perf_counter()
            super().submit()
            self.gpu.wait()
            self._spent_s = time.perf_counter() - begin
