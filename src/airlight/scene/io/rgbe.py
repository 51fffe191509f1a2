"""Radiance .hdr: 8-bit mantissas with a shared exponent, run-length encoded by scanline.

Source: Ward, "Real Pixels", Graphics Gems II (1991), and the Radiance file format reference.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import F32

_SIZE = re.compile(rb"([-+])([XY]) (\d+) ([-+])([XY]) (\d+)\s*\Z")


def decode(raw: bytes, path: Path) -> F32:
    """Linear (H, W, 3) float32, top row first, of the bytes of a .hdr file.

    Raises SceneError, naming `path`, for bytes that are not one or end early.
    """
    if not raw.startswith(b"#?"):
        raise SceneError("not a Radiance HDR file", where=path)
    header, _, rest = raw.partition(b"\n\n")
    if b"32-bit_rle_xyze" in header:
        raise SceneError("XYZE colours are not supported", where=path, remedy="Save it as RGBE.")
    line, _, body = rest.partition(b"\n")
    size = _SIZE.match(line)
    if size is None or size[2] != b"Y":
        raise SceneError("its HDR header has no size '-Y height +X width'", where=path)
    height, width = int(size[3]), int(size[6])
    if not 0 < height * width <= 2**28:
        raise SceneError(f"an image of {width} x {height} pixels cannot be", where=path)
    try:
        quads = _quads(body, height, width)
    except (IndexError, ValueError):
        raise SceneError("the file is truncated or damaged", where=path) from None
    quads = quads[::-1] if size[1] == b"+" else quads
    quads = quads[:, ::-1] if size[4] == b"-" else quads
    return _radiance(quads) / np.float32(_exposure(header))


def _exposure(header: bytes) -> float:
    """Radiance divides by the product of all EXPOSURE lines."""
    values = [float(v) for v in re.findall(rb"(?m)^EXPOSURE=\s*([0-9.eE+-]+)", header)]
    product = float(np.prod(values)) if values else 1.0
    return product if np.isfinite(product) and product > 0.0 else 1.0


def _radiance(quads: NDArray[np.uint8]) -> F32:
    exponent = quads[..., 3].astype(np.int32)
    scale = np.where(exponent > 0, np.ldexp(1.0, exponent - 136), 0.0)
    # Ward adds half a step; everyone else's readers do not, and black must stay black.
    return (quads[..., :3] * scale[..., None]).astype(np.float32)


def _quads(body: bytes, height: int, width: int) -> NDArray[np.uint8]:
    """RGBE bytes (height, width, 4)."""
    if not 8 <= width < 32768 or body[:2] != b"\x02\x02" or body[2] & 0x80:
        flat = np.frombuffer(body, dtype=np.uint8, count=height * width * 4)
        return flat.reshape(height, width, 4)
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
