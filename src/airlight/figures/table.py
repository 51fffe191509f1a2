"""Tables of numbers as images."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

from ..app.compare.images import FAINT, INK, PAPER
from ..maths.arrays import U8

MARGIN_PX, LINE_PX, COLUMN_PX = 24, 34, 190


def table_image(lines: Sequence[Sequence[str]], columns: Sequence[int]) -> U8:
    """Lines of cells as text; the first and the last are faint: a head, and a note.

    `columns`: how wide each is, in units of COLUMN_PX.
    """
    starts = MARGIN_PX + COLUMN_PX * np.cumsum([0, *columns])
    size = (int(starts[-1]), 2 * MARGIN_PX + LINE_PX * len(lines))
    image = PIL.Image.new("RGB", size, PAPER)
    pen, font = PIL.ImageDraw.Draw(image), PIL.ImageFont.load_default(18)
    for row, cells in enumerate(lines):
        for start, text in zip(starts, cells, strict=False):
            corner = (float(start), float(MARGIN_PX + LINE_PX * row))
            pen.text(corner, text, FAINT if row in (0, len(lines) - 1) else INK, font=font)
    return np.asarray(image, dtype=np.uint8)
