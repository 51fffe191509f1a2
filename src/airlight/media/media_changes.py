"""Which media changed between versions of their table, by the boxes that they left and entered.

What a change cannot reach stays as it is: light on a path that meets none of these boxes arrives as
before.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

MOST_BOXES = 32
"""More are as good as everywhere."""
_REMEMBERED = 8  # versions that a reader may lag behind


class MediaChanges:
    """The boxes, as `volume_from_world` of the table has them, that changes touched, by version."""

    def __init__(self) -> None:
        self._rows: list[tuple[bytes, int]] = []
        self._boxes = np.zeros((0, 4, 4), np.float32)
        self._log: deque[tuple[int, NDArray[np.float32] | None]] = deque(maxlen=_REMEMBERED)

    def take(
        self, version: int, table: bytes, boxes: NDArray[np.float32], grids: Sequence[int]
    ) -> None:
        """Note the media of `version` (the last one's successor): each has a row of the `table`.

        `boxes`: of its `volume_from_world`; `grids`: the version of each medium's densities.
        """
        # A medium's row and the version of its grid; with another number of media all may differ.
        size = len(table) // max(1, len(boxes))
        rows = [(table[i * size : (i + 1) * size], grid) for i, grid in enumerate(grids)]
        touched = None
        if len(rows) == len(self._rows):
            pairs = zip(rows, self._rows, strict=True)
            changed = [i for i, (now, before) in enumerate(pairs) if now != before]
            touched = np.concatenate([self._boxes[changed], boxes[changed]])
        self._rows, self._boxes = rows, boxes
        self._log.append((version, touched))

    def since(self, version: int, now: int) -> NDArray[np.float32] | None:
        """The boxes touched after `version` until `now`; None where they may be anywhere."""
        # Boxes of all versions since then, unless the log has forgotten one.
        later = [touched for of, touched in self._log if of > version]
        if len(later) != now - version or any(touched is None for touched in later):
            return None
        boxes = [touched for touched in later if touched is not None]
        if not boxes:
            return self._boxes[:0]
        # A medium may have moved more than once.
        found = np.unique(np.concatenate(boxes), axis=0)
        return found if len(found) <= MOST_BOXES else None
