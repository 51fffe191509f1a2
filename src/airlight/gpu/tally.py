"""What passes bind and how often they run, counted while a frame is encoded."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any


@dataclass
class Count:
    """Of one stage."""

    passes: int = 0
    """Dispatches, draws over whole images, and passes over meshes."""
    invocations: int = 0
    """Threads that they start: of whole workgroups, one a pixel, or one a mesh's vertex."""
    nbytes: int = 0
    """Of all that they bind, a resource once for each pass: what is read or written at least once
    where a pass needs all of it; caches, and reading twice, are not in it."""


class Tally:
    """Counts by stage; not the pixels that meshes cover, nor the targets they are drawn into."""

    def __init__(self) -> None:
        self.stages: dict[str, Count] = {}

    def bound(self, stage: str, resources: Iterable[Any]) -> None:
        """A pass binds these; views and samplers have no size, parameters are not counted."""
        distinct = {id(r): int(getattr(r, "nbytes", 0)) for r in resources}
        self._of(stage).nbytes += sum(distinct.values())

    def ran(self, stage: str, invocations: int) -> None:
        """A pass runs so often."""
        count = self._of(stage)
        count.passes += 1
        count.invocations += invocations

    def _of(self, stage: str) -> Count:
        return self.stages.setdefault(stage, Count())
