"""Rows of four words in a texture, for shaders that read them in no order.

Neighbouring invocations follow rays of their own, so each reads rows of its own. CPU adapters take
a row of a texture in a quarter of the time that they take for one of a buffer, which they read word
by word and invocation by invocation.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..gpu.device import Gpu
from ..gpu.memory import Texture
from .hierarchy import U32

LINE_BITS = 12
"""Of the number of rows in a line of the texture; wgsl/ray_rows.wgsl has it, too."""
LINE = 1 << LINE_BITS
_WORDS = 4


class Rows:
    """`count` rows of four words each; `texture` is what passes bind."""

    def __init__(self, gpu: Gpu, label: str, count: int) -> None:
        """Raises DeviceError where the device has no texture of so many lines."""
        self.texture = Texture(gpu, label, (LINE, max(1, -(-count // LINE))), "rgba32uint")
        self.nbytes = self.texture.nbytes

    def write(self, words: U32, first: int = 0) -> None:
        """Upload whole rows from number `first` on: the rest of its line, lines, and a part of one."""
        rows = np.ascontiguousarray(words).reshape(-1, _WORDS)
        begin = 0
        while begin < len(rows):
            line, column = divmod(first + begin, LINE)
            lines = (len(rows) - begin) // LINE if column == 0 else 0
            count = lines * LINE if lines else min(LINE - column, len(rows) - begin)
            texels: Any = rows[begin : begin + count].reshape(max(lines, 1), -1, _WORDS)
            self.texture.write(texels, row=line, column=column)
            begin += count

    def release(self) -> None:
        """Free the texture."""
        self.texture.release()
