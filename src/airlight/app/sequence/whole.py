"""Whether a frame or a video is all there: one that was cut off is made again by --resume.

Only the structure is read, not a pixel: PNG's chunks and their checksums, the table of an
OpenEXR file's blocks of lines, and the boxes of an MP4.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from ...errors import SceneError
from ...scene.io.files import opened
from ...scene.io.ledger import own_files

_PNG_HEAD, _PNG_END = b"\x89PNG\r\n\x1a\n", b"IEND"
_EXR_MAGIC, _EXR_ZIP, _EXR_LINES = 20000630, 3, 16
_LONGEST_NAME = 255


def is_whole(path: Path) -> bool:
    """Whether the file at `path` (.png, .exr or .mp4) is there and reaches to its own end."""
    try:
        with own_files(), opened(path) as file:
            # The size, then back to the beginning.
            size = file.seek(0, 2)
            file.seek(0)
            return _CHECKS[path.suffix.lower()](file, size)
    except (SceneError, struct.error):  # struct.error: it ends within a number
        return False


def _png(file: BinaryIO, size: int) -> bool:
    if file.read(8) != _PNG_HEAD:
        return False
    # Chunk after chunk, each with the checksum of its kind and data, up to the last one's.
    while file.tell() < size:
        length, kind = struct.unpack(">I4s", file.read(8))
        if file.tell() + length + 4 > size:
            return False
        (checksum,) = struct.unpack_from(">I", block := file.read(length + 4), length)
        if zlib.crc32(block[:length], zlib.crc32(kind)) != checksum:
            return False
        if kind == _PNG_END:
            return file.tell() == size
    return False


def _exr(file: BinaryIO, size: int) -> bool:
    """As `scene.io.exr` writes them: one part, ZIP compression, 16 lines to a block."""
    if struct.unpack("<i", file.read(8)[:4])[0] != _EXR_MAGIC:
        return False
    # The header: attributes by name, each with its type and length.
    known: dict[bytes, bytes] = {}
    while name := _text(file):
        _text(file)
        (length,) = struct.unpack("<i", file.read(4))
        if not 0 <= length <= size - file.tell():
            return False
        known[name] = file.read(length)
    # How many blocks there must be, by the rows of the image.
    if known.get(b"compression") != bytes([_EXR_ZIP]):
        return False
    _, low, _, high = struct.unpack("<4i", known.get(b"dataWindow", b""))
    count = (high - low) // _EXR_LINES + 1
    if not 0 < count <= size // 8:
        return False
    # Each block says which line it begins with, and how many bytes follow.
    end = 0
    for k, start in enumerate(struct.unpack(f"<{count}Q", file.read(8 * count))):
        file.seek(min(start, size))
        line, length = struct.unpack("<2i", file.read(8))
        if line != low + k * _EXR_LINES:
            return False
        end = max(end, start + 8 + length)
    # The file has to end with the block that lies last.
    return end == size


def _text(file: BinaryIO) -> bytes:
    """Bytes up to a zero, which is left out."""
    found = b""
    while (letter := file.read(1)) not in (b"", b"\0"):
        found += letter
        if len(found) > _LONGEST_NAME:
            return b""
    return found


def _mp4(file: BinaryIO, size: int) -> bool:
    place = 0
    # Boxes follow each other, each behind its length; 1 stands for a length of 64 bits.
    while place < size:
        file.seek(place)
        length, _ = struct.unpack(">I4s", file.read(8))
        if length == 1:
            (length,) = struct.unpack(">Q", file.read(8))
        if length < 8:
            return False
        place += length
    return place == size and size > 0


_CHECKS: dict[str, Callable[[BinaryIO, int], bool]] = {".png": _png, ".exr": _exr, ".mp4": _mp4}
