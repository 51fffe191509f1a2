"""Commands for work in the background of a viewer: pass by pass, between its frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from .commands import Commands
from .device import Gpu


class SlicedCommands(Commands):
    """Submits each pass by itself and waits for it; the results are the same bits.

    `turn` makes a context in which a pass is submitted and waited for. An exception from it, which
    stops the work, goes through whatever is encoding; that can then only be released.
    """

    is_recordable = False

    def __init__(self, gpu: Gpu, turn: Callable[[], AbstractContextManager[Any]]) -> None:
        super().__init__(gpu)
        self._turn = turn

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

    def submit(self) -> None:
        """Hand over what is encoded, and wait for it."""
        if self._encoder is None:
            return
        with self._turn():
            super().submit()
            self.gpu.wait()
