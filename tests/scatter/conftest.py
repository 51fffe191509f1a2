"""Lattices on the device, from and to NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest


@pytest.fixture
def lattice(gpu: Any) -> Any:
    """lattice(array) -> Buffer of float32 (or of the array's own integers)."""
    from airlight.gpu.memory import buffer_of

    made = []

    def upload(values: np.ndarray) -> Any:
        kept = values if values.dtype.kind in "ui" else values.astype(np.float32)
        made.append(buffer_of(gpu, "test", np.ascontiguousarray(kept)))
        return made[-1]

    yield upload
    for buffer in made:
        buffer.release()


@pytest.fixture
def commands(gpu: Any) -> Any:
    """An encoder; `submit` before reading."""
    from airlight.gpu.commands import Commands

    return Commands(gpu)
