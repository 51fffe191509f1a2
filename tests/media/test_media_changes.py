"""What changed since a version is told by the boxes before and after, or as everything."""

from __future__ import annotations

import numpy as np

from airlight.media.media_changes import MOST_BOXES, MediaChanges


def taken(changes: MediaChanges, version: int, rows: list[tuple[float, int]]) -> None:
    """A version of a table whose rows are a number each; boxes are that number's."""
    table = np.array([x for x, _ in rows], np.float32)
    boxes = np.multiply.outer(table, np.eye(4, dtype=np.float32))
    changes.take(version, table.tobytes(), boxes, [grid for _, grid in rows])


def since(changes: MediaChanges, version: int, now: int) -> set[float] | None:
    found = changes.since(version, now)
    return None if found is None else {float(box[0, 0]) for box in found}


def test_a_row_that_changed_brings_its_box_before_and_after() -> None:
    changes = MediaChanges()
    taken(changes, 1, [(1.0, 0), (2.0, 0), (3.0, 0)])
    assert since(changes, 0, 1) is None  # the first is all new
    assert since(changes, 1, 1) == set()
    taken(changes, 2, [(1.0, 0), (5.0, 0), (3.0, 0)])
    assert since(changes, 1, 2) == {2.0, 5.0}
    # Other densities in the same place.
    taken(changes, 3, [(1.0, 0), (5.0, 0), (3.0, 7)])
    assert since(changes, 2, 3) == {3.0}
    assert since(changes, 1, 3) == {2.0, 3.0, 5.0}


def test_what_is_forgotten_or_much_is_everything() -> None:
    changes = MediaChanges()
    for version in range(1, 12):
        taken(changes, version, [(1.0, 0), (float(version), 0)])
    assert since(changes, 10, 11) == {10.0, 11.0}
    assert since(changes, 1, 11) is None
    taken(changes, 12, [(1.0, 0)])
    assert since(changes, 11, 12) is None  # another number of media
    many = MediaChanges()
    taken(many, 1, [(float(k), 0) for k in range(MOST_BOXES)])
    taken(many, 2, [(k + 0.5, 0) for k in range(MOST_BOXES)])
    assert since(many, 1, 2) is None
