"""Radiance .hdr: 8-bit mantissas with a shared exponent, run-length encoded by scanline.

Source: Ward1991, and the Radiance file format reference.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import F32
from .image_sizes import check_size

_LEAST_EXPOSURE = 1e-12
_SIZE = re.compile(rb"([-+])([XY]) (\d{1,9}) ([-+])([XY]) (\d{1,9})\s*\Z")


def decode(raw: bytes, path: Path) -> F32:
    """Linear (H, W, 3) float32, top row first, of the bytes of a .hdr file.

    Raises SceneError, naming `path`, for bytes that are not one or end early.
    """
    if not raw.startswith(b"#?"):
        # Header lines end with an empty one; what follows is the size, then pixels.
        raise SceneError("not a Radiance HDR file", where=path)
    header, _, rest = raw.partition(b"\n\n")
    if b"32-bit_rle_xyze" in header:
        raise SceneError("XYZE colours are not supported", where=path, remedy="Save it as RGBE.")
    # The size, and which way rows and columns go.
    line, _, body = rest.partition(b"\n")
    size = _SIZE.match(line)
    if size is None or size[2] != b"Y":
        raise SceneError("its HDR header has no size '-Y height +X width'", where=path)
    height, width = int(size[3]), int(size[6])
    if height * width == 0:
        raise SceneError(f"an image of {width} x {height} pixels cannot be", where=path)
    # Sizes are checked against the file before any memory is taken for pixels.
    check_size(width, height, len(raw), path)
    if len(body) < height * _fewest_bytes(width):
        raise SceneError("the file is truncated or damaged", where=path)
    # Pixels of a shared exponent, the top row first.
    try:
        quads = _quads(body, height, width)
    except (IndexError, ValueError):
        raise SceneError("the file is truncated or damaged", where=path) from None
    quads = quads[::-1] if size[1] == b"+" else quads
    quads = quads[:, ::-1] if size[4] == b"-" else quads
    return (_radiance(quads) / _exposure(header, path)).astype(np.float32)


def _fewest_bytes(width: int) -> int:
    """What a scanline takes at least: four channels of runs of 127, or pixels as they are."""
    return 4 + 8 * -(-width // 127) if 8 <= width < 32768 else 4 * width


def _exposure(header: bytes, path: Path) -> float:
    """Radiance divides by the product of all EXPOSURE lines. Raises SceneError."""
    product = 1.0
    # Each line tells of a scaling that a program has done, which is undone.
    for written in re.findall(rb"(?m)^EXPOSURE=[ \t]*(.*)$", header):
        text = written.decode("ascii", "replace").strip()
        try:
            product *= float(text)
        except ValueError:
            product = math.nan
        # NaN is in no range either.
        if not _LEAST_EXPOSURE <= product <= 1.0 / _LEAST_EXPOSURE:
            raise SceneError(
                f"its EXPOSURE={text[:40]} is not from {_LEAST_EXPOSURE:g} to "
                f"{1.0 / _LEAST_EXPOSURE:g}",
                where=path,
            )
    return product


def _radiance(quads: NDArray[np.uint8]) -> F32:
    # Exponents are stored plus 128, and mantissas count 256ths; exponent 0 is black.
    exponent = quads[..., 3].astype(np.int32)
    scale = np.where(exponent > 0, np.ldexp(1.0, exponent - 136), 0.0)
    # Ward adds half a step; everyone else's readers do not, and black must stay black.
    return (quads[..., :3] * scale[..., None]).astype(np.float32)


def _quads(body: bytes, height: int, width: int) -> NDArray[np.uint8]:
    """RGBE bytes (height, width, 4)."""
    # Old files are flat; the marker of run-length coding is no normalised colour, so that none
    # begins with it.
    if not 8 <= width < 32768 or body[:2] != b"\x02\x02" or body[2] & 0x80:
        flat = np.frombuffer(body, dtype=np.uint8, count=height * width * 4)
        return flat.reshape(height, width, 4)
    # Each line stores its four channels one after the other, packed for themselves.
    rows = np.empty((height, 4, width), dtype=np.uint8)
    at = 0
    for y in range(height):
        if body[at : at + 2] != b"\x02\x02" or (body[at + 2] << 8 | body[at + 3]) != width:
            raise ValueError
        line, at = _unpacked(body, at + 4, 4 * width)
        rows[y] = np.frombuffer(line, dtype=np.uint8).reshape(4, width)
    return rows.transpose(0, 2, 1)


def _unpacked(body: bytes, at: int, count: int) -> tuple[bytearray, int]:
    """`count` bytes of one scanline from offset `at`, and the offset after them.

    A loop over packets, of which each says where the next begins; never over pixels.
    """
    line = bytearray()
    while len(line) < count:
        # Above 128 one byte is repeated, else that many follow.
        length = body[at]
        if length > 128:
            line += body[at + 1 : at + 2] * (length - 128)
            at += 2
        else:
            line += body[at + 1 : at + 1 + length]
            at += 1 + length
        if length == 0 or at > len(body):
            raise ValueError
    if len(line) != count:
        raise ValueError
    return line, at


def encode(radiance: F32) -> bytes:
    """The bytes of a .hdr file of linear (H, W, 3); negative and NaN become 0; not packed."""
    height, width = radiance.shape[:2]
    # Infinite pixels become a number that the format's exponent can hold.
    c = np.clip(np.nan_to_num(radiance.astype(np.float64), posinf=1e38), 0.0, 1e38)
    peak = c.max(axis=2)
    _, exponent = np.frexp(peak)
    quads = np.zeros((height, width, 4), dtype=np.uint8)
    # frexp puts the peak in [0.5, 1), so its mantissa is 128 to 255 and never reads as packed.
    lit = peak > 1e-32
    mantissa = np.floor(np.ldexp(c, 8 - exponent[..., None])).astype(np.uint8)
    quads[..., :3] = np.where(lit[..., None], mantissa, 0)
    quads[..., 3] = np.where(lit, exponent + 128, 0)
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    return header.encode("ascii") + quads.tobytes()
