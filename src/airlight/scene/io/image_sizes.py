"""How large an image may say that it is: a few kilobytes can unpack to all memory there is."""

from __future__ import annotations

from ...errors import SceneError

MAX_TEXTURE_PIXELS = 16384 * 16384
"""Larger images are refused."""
MODEST_PIXELS = 1 << 24
"""Pixels that any image may have."""
PIXELS_PER_BYTE = 1024
"""Pixels for each byte of a file that has more: emptier ones are one colour all over."""


def check_size(width: int, height: int, file_bytes: int, name: object, *, layers: int = 1) -> None:
    """Raise SceneError for more pixels than are possible, or than the file's size bears out.

    `layers` is how many triples of channels every pixel has.
    """
    pixels = width * height
    # What no image may have, whatever the size of its file.
    if pixels > MAX_TEXTURE_PIXELS:
        raise SceneError(
            f"image of {width} x {height} pixels is too large",
            where=name,
            remedy=f"Scale it to at most {MAX_TEXTURE_PIXELS} pixels.",
        )
    # Small images may be of one colour all over; larger ones need bytes that bear them out.
    if pixels * layers > max(MODEST_PIXELS, PIXELS_PER_BYTE * file_bytes):
        raise SceneError(
            f"{file_bytes:,} bytes are too few for an image of {width} x {height} pixels",
            where=name,
            remedy="Scale it down.",
        )
