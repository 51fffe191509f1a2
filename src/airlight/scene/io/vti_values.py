"""How VTK's image data store values: ASCII, base64 or appended, packed by zlib or LZMA."""

from __future__ import annotations

import base64
import binascii
import lzma
import re
import zlib
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError

TYPES = {
    "Int8": "i1",
    "UInt8": "u1",
    "Int16": "i2",
    "UInt16": "u2",
    "Int32": "i4",
    "UInt32": "u4",
    "Int64": "i8",
    "UInt64": "u8",
    "Float32": "f4",
    "Float64": "f8",
}
_MOST_BLOCKS = 1 << 24
_UNPACKERS: dict[str, Any] = {
    "vtkZLibDataCompressor": zlib.decompressobj,
    "vtkLZMADataCompressor": lzma.LZMADecompressor,
}


@dataclass(frozen=True)
class VtiFile:
    """The parsed head, how binary values are stored, and the appended ones."""

    image: ElementTree.Element
    order: str
    header: str
    compressor: str
    appended: bytes
    is_raw: bool


def values_of(file: VtiFile, element: ElementTree.Element, count: int) -> NDArray[Any]:
    """The `count` values of a DataArray element."""
    dtype = np.dtype(file.order + TYPES[element.get("type", "Float32")])
    form = element.get("format", "ascii")
    if form == "ascii":
        values = np.array((element.text or "").split(), np.float64)
        if len(values) != count:
            raise ValueError(f"it has {len(values):,} values, its extent asks for {count:,}")
        return values.astype(dtype)
    # Appended data lie behind all elements, binary ones within them; either is packed in the same
    # blocks.
    if form == "appended":
        stored = file.appended[int(element.get("offset", "0")) :]
        stored = stored if file.is_raw else _from_base64(stored)
    elif form == "binary":
        stored = _from_base64((element.text or "").encode())
    else:
        raise ValueError(f"its format '{form}' is unknown")
    raw = _unpacked(file, stored, count * dtype.itemsize)
    return np.frombuffer(raw, dtype).astype(dtype.newbyteorder("="))


def _from_base64(text: bytes) -> bytes:
    """Bytes of one or more base64 texts on end: a header is often padded on its own."""
    try:
        return b"".join(
            base64.b64decode(part, validate=True)
            for part in re.findall(rb"[^=]+=*", b"".join(text.split()))
        )
    except binascii.Error as error:
        raise ValueError(f"its base64 is damaged ({error})") from None


def _unpacked(file: VtiFile, stored: bytes, wanted: int) -> bytes:
    """`wanted` bytes behind their header: their number, or of blocks the number and all sizes."""
    size = np.dtype(file.header).itemsize
    # Plain values follow their number of bytes.
    if not file.compressor:
        length = int(np.frombuffer(stored, file.header, 1)[0])
        if length != wanted or len(stored) < size + wanted:
            raise ValueError(f"it has {min(length, len(stored)):,} bytes of values, not {wanted:,}")
        return stored[size : size + wanted]
    if file.compressor not in _UNPACKERS:
        raise SceneError(
            f"is packed by {file.compressor}, only zlib and LZMA are read",
            remedy="Write it with zlib, or not packed.",
        )
    # Of packed blocks, the header says how many there are, how large, and how long each is packed.
    blocks, block_size, last = (int(n) for n in np.frombuffer(stored, file.header, 3))
    expected = blocks * block_size - (block_size - last if last else 0)
    if blocks > _MOST_BLOCKS or expected != wanted:
        raise ValueError(f"its blocks hold {expected:,} bytes of values, not {wanted:,}")
    # No block may unpack to more than it says: a small file could fill the memory.
    packed = np.frombuffer(stored, file.header, blocks, 3 * size).astype(np.int64)
    at, parts = (3 + blocks) * size, []
    for length in packed.tolist():
        unpacker = _UNPACKERS[file.compressor]()
        parts.append(unpacker.decompress(stored[at : at + length], block_size + 1))
        at += length
    made = b"".join(parts)
    if len(made) != wanted:
        raise ValueError(f"its blocks hold {len(made):,} bytes of values, not {wanted:,}")
    return made
