"""Pieces of long arrays."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.chunks import chunks


@pytest.mark.parametrize("count", [0, 1, 5, 6, 17])
def test_they_cover_everything_once_and_in_order(count):
    rows = np.arange(count)
    parts = [rows[part] for part in chunks(count, 6)]
    np.testing.assert_array_equal(np.concatenate([rows[:0], *parts]), rows)
    assert all(1 <= len(part) <= 6 for part in parts)
