"""Blocks of lines that hold numbers alone, tens of megabytes at a time, in NumPy's C parser."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...maths.arrays import F64, I64, U8

SPACE, NEWLINE = 32, 10


def parsed(text: bytes, dtype: type[np.generic]) -> NDArray[Any] | None:
    """Numbers separated by white space, or None where something else stands among them."""
    if not text.strip():
        return np.zeros(0, dtype=dtype)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # NumPy 1 warns where 2 raises
        try:
            return np.fromstring(text.decode("latin-1"), dtype=dtype, sep=" ")
        except (ValueError, DeprecationWarning):
            return None


def _token_starts(data: U8) -> NDArray[np.bool_]:
    blank = (data == SPACE) | (data == NEWLINE)
    starts: NDArray[np.bool_] = ~blank & np.concatenate([[True], blank[:-1]])
    return starts


def token_counts(text: bytes) -> I64:
    """How many words stand on each line."""
    # Of each line's end, how many words had begun up to there.
    data = np.frombuffer(text, dtype=np.uint8)
    ends = np.flatnonzero(data == NEWLINE)
    total = np.cumsum(_token_starts(data))
    return np.diff(total[ends], prepend=0).astype(np.int64)


def slashes_per_token(text: bytes) -> I64:
    """How many slashes each word has: a corner a/b/c has two."""
    data = np.frombuffer(text, dtype=np.uint8)
    starts = np.flatnonzero(_token_starts(data))
    if len(starts) == 0:
        return np.zeros(0, dtype=np.int64)
    return np.add.reduceat((data == ord("/")).astype(np.int64), starts)


def rows_of(values: F64, sizes: I64, start: int, width: int) -> F64:
    """Numbers start .. start + width of each line, (n, width)."""
    rows: F64
    # Lines of one length are a table; of others the first numbers are picked.
    if len(sizes) and (sizes == sizes[0]).all():
        rows = values.reshape(len(sizes), -1)[:, start : start + width].copy()
    else:
        first = np.cumsum(sizes) - sizes + start
        rows = values[first[:, None] + np.arange(width)]
    return rows
