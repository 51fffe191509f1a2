"""The images of a comparison: tone mapped, signed differences, FLIP maps, contact sheet."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from typing import Any

import numpy as np
import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont

from ...maths.arrays import F32, F64, U8
from ...maths.colour import luminance, srgb_encode
from ...maths.tone import display_srgb8
from ...reference.metrics_display import displayed

FULL_DIFFERENCE = 0.25
"""The difference of displayed luminance, of 1, that gets the full colour."""
TOO_BRIGHT = np.array([0.15, 0.90, 0.35])  # linear Rec.709
TOO_DARK = np.array([0.95, 0.06, 0.04])
MAGMA = np.array(  # every eighth of matplotlib's map, 8-bit sRGB
    [
        (0, 0, 4),
        (28, 16, 68),
        (79, 18, 123),
        (129, 37, 129),
        (181, 54, 122),
        (229, 80, 100),
        (251, 135, 97),
        (254, 194, 135),
        (252, 253, 191),
    ],
    dtype=np.float64,
)
SMALLEST_PX = 11  # of captions
PAPER, INK, FAINT = (22, 22, 24), (232, 232, 230), (150, 150, 152)


def shown(radiance: F32, stops: float) -> U8:
    """As an image on a display, AgX; (H, W, 3)."""
    return display_srgb8(radiance, stops, "agx", dither=True)


def signed_map(image: F32, reference: F32, stops: float) -> U8:
    """Green where too bright, red where too dark, as Kaplanyan2010 Fig. 6; (H, W, 3).

    Of displayed luminance (sRGB, exposed by `stops`), so that it shows what an eye would.
    """
    # Displayed luminance of both, and the part of the full colour that the difference gets.
    a, b = (luminance(displayed(c, stops)) for c in (image, reference))
    d = np.clip((a - b) / FULL_DIFFERENCE, -1.0, 1.0)[..., None]
    linear: F64 = np.where(d > 0.0, d * TOO_BRIGHT, -d * TOO_DARK)
    return np.rint(255.0 * srgb_encode(linear)).astype(np.uint8)


def heat(error: F32) -> U8:
    """A map (H, W) of errors in [0, 1] in the colours FLIP is drawn in; (H, W, 3)."""
    # Between the map's eighths, linearly in code values.
    at = np.clip(np.asarray(error, dtype=np.float64), 0.0, 1.0) * (len(MAGMA) - 1)
    rgb = [np.interp(at, np.arange(len(MAGMA)), MAGMA[:, c]) for c in range(3)]
    return np.rint(np.stack(rgb, axis=-1)).astype(np.uint8)


def png_bytes(pixels: U8) -> bytes:
    """A PNG file of (H, W, 3)."""
    buffer = io.BytesIO()
    PIL.Image.fromarray(pixels).save(buffer, "PNG", optimize=False, compress_level=7)
    return buffer.getvalue()


def data_url(pixels: U8) -> str:
    """The image as a URL that holds it."""
    return "data:image/png;base64," + base64.b64encode(png_bytes(pixels)).decode("ascii")


Row = tuple[str, Sequence[tuple[str, U8 | None]]]
"""A row's name, and its captioned images; None leaves a gap."""


def contact_sheet(
    title: str, rows: Sequence[Row], *, cell_width_px: int = 400, caption_px: int = 14
) -> U8:
    """All images on one sheet, a row each, captions above; (H, W, 3).

    A row is as high as its first image, scaled to the cells' width.
    """
    # Rows are as high as their images, columns all as wide as a cell.
    heights = [_height_px(cells, cell_width_px) for _, cells in rows]
    margin, caption, head = 16, caption_px + 12, 4 * caption_px
    columns = max(len(cells) for _, cells in rows)
    width = margin + columns * (cell_width_px + margin)
    tops = np.cumsum([head, *(caption + height + margin for height in heights)])
    sheet = PIL.Image.new("RGB", (width, int(tops[-1])), PAPER)
    draw = PIL.ImageDraw.Draw(sheet)
    large = PIL.ImageFont.load_default(1.6 * caption_px)
    draw.text((margin, caption_px + 2), title, INK, font=large)
    # Captions narrow until they fit; an image that is missing has a faint one.
    for (name, cells), top, height in zip(rows, tops[:-1].tolist(), heights, strict=True):
        for c, (label, pixels) in enumerate(cells):
            x = margin + c * (cell_width_px + margin)
            text = f"{name} · {label}" if name else label
            font = _narrow(text, cell_width_px, caption_px)
            text = _fitted(text, cell_width_px, font)
            draw.text((x, top + 4), text, FAINT if pixels is None else INK, font=font)
            if pixels is not None:
                small = PIL.Image.fromarray(pixels)
                # An image of another size is scaled to its cell.
                if small.size != (cell_width_px, height):
                    size = (cell_width_px, height)
                    small = small.resize(size, PIL.Image.Resampling.LANCZOS)
                sheet.paste(small, (x, top + caption))
    return np.asarray(sheet, dtype=np.uint8)


def _height_px(cells: Sequence[tuple[str, U8 | None]], width_px: int) -> int:
    """Of a row whose images are `width_px` wide."""
    first = next((p for _, p in cells if p is not None), None)
    return 1 if first is None else max(1, round(first.shape[0] * width_px / first.shape[1]))


def _narrow(text: str, width_px: int, size_px: int) -> Any:
    """The font at its size; smaller, down to what can be read, where the text is too long."""
    font = PIL.ImageFont.load_default(size_px)
    # A narrower font, but none that cannot be read.
    share = width_px / max(font.getlength(text), 1.0)
    if share >= 1.0:
        return font
    return PIL.ImageFont.load_default(max(float(SMALLEST_PX), 0.98 * share * size_px))


def _fitted(text: str, width_px: int, font: Any) -> str:
    """The text, shortened with an ellipsis to what fits."""
    if font.getlength(text) <= width_px:
        return text
    fits = (text[:n] for n in range(len(text), 0, -1))
    return next((t + "…" for t in fits if font.getlength(t + "…") <= width_px), "…")
