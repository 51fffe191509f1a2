"""The table of lattices that shaders loop over, the finest first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from .placement import LatticeParams


class LatticeTable:
    """A storage buffer of `LatticeParams`; its length is the number of lattices."""

    def __init__(self, gpu: Gpu, count: int = 1) -> None:
        self.count = count
        self.buffer = Buffer(gpu, "lattices", count * LatticeParams.dtype.itemsize)
        self._written = b""

    def filled(self, rows: Sequence[LatticeParams]) -> Buffer:
        """The buffer that holds `rows`, the finest lattice first; uploaded where they changed.

        Raises ValueError where there are not as many as the table is long.
        """
        if len(rows) != self.count:
            raise ValueError(f"{len(rows)} lattices in a table of {self.count}")

        # Compared as bytes: most frames upload nothing.
        packed = np.array([row.record for row in rows], LatticeParams.dtype)
        if packed.tobytes() != self._written:
            self._written = packed.tobytes()
            self.buffer.write(packed)
        return self.buffer
