"""Mitsuba's `.serialized` meshes: several in one file, each compressed by itself.

Source: Mitsuba 3 documentation, "Serialized mesh loader": a header, one zlib stream a mesh, and
at the file's end where each stream begins.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..mesh import Geometry
from .files import read_bytes

_MAGIC = 0x041C
_NORMALS, _UVS, _COLORS = 0x0001, 0x0002, 0x0008
_DOUBLE = 0x2000
_MOST_PER_BYTE = 1032  # what zlib reaches at best


def read_serialized(path: Path, index: int) -> Geometry:
    """Mesh number `index` of a file. Raises SceneError naming what is wrong with it."""
    raw = read_bytes(path)
    begin, end, version = _extent(raw, index, path)
    try:
        # Past its own magic and version, four bytes, a mesh is one zlib stream.
        data = zlib.decompressobj().decompress(raw[begin + 4 : end], len(raw) * _MOST_PER_BYTE)
        return _Reader(data).mesh(has_name=version == 4)
    except (zlib.error, struct.error, ValueError) as error:
        raise SceneError(
            f"mesh {index} of the .serialized file is damaged: {error}",
            where=path,
            remedy="Copy or export it again.",
        ) from None


def _extent(raw: bytes, index: int, path: Path) -> tuple[int, int, int]:
    """Where mesh `index` begins and ends, and the version of its format."""
    # The table of offsets stands at the end, its length last.
    if len(raw) < 8:
        raise SceneError(f"it ends after {len(raw)} bytes", where=path)
    (count,) = struct.unpack_from("<I", raw, len(raw) - 4)
    magic, version = struct.unpack_from("<HH", raw, 0)
    if magic != _MAGIC or version not in (3, 4):
        raise SceneError("it is no .serialized file of version 3 or 4", where=path)
    # Offsets have eight bytes since version 4.
    width = 8 if version == 4 else 4
    table = len(raw) - 4 - count * width
    if not 0 < count <= len(raw) // width or table < 8:
        raise SceneError(f"its table names {count} meshes, more than it holds", where=path)
    if not 0 <= index < count:
        raise SceneError(f"shape_index is {index}, but the file holds {count} meshes", where=path)
    # The mesh ends where the next one begins.
    offsets = np.frombuffer(raw, "<u8" if version == 4 else "<u4", count, table).astype(np.int64)
    begin, end = int(offsets[index]), int(offsets[index + 1]) if index + 1 < count else table
    if not 0 <= begin <= end - 4 <= table:
        raise SceneError(f"mesh {index} begins at byte {begin} of {len(raw)}", where=path)
    return begin, end, struct.unpack_from("<H", raw, begin + 2)[0]


class _Reader:
    """The decompressed bytes of one mesh, read from the front."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def mesh(self, *, has_name: bool) -> Geometry:
        # What each vertex has.
        flags, *_ = self.unpack("<I")
        # A name, ended by a zero byte, came with version 4.
        if has_name:
            self.at = self.data.index(b"\0", self.at) + 1
        vertices, triangles = self.unpack("<QQ")
        # Arrays, one after the other.
        real = "<f8" if flags & _DOUBLE else "<f4"
        positions = self.rows(real, vertices, 3)
        normals = self.rows(real, vertices, 3) if flags & _NORMALS else None
        uvs = self.rows(real, vertices, 2) if flags & _UVS else None
        colors = self.rows(real, vertices, 3) if flags & _COLORS else None
        # Indices are as wide as the number of vertices needs.
        indices = self.rows("<u8" if vertices > 0xFFFFFFFF else "<u4", triangles, 3)
        if not triangles or indices.max() >= vertices:
            raise ValueError(f"its triangles do not fit its {vertices} vertices")
        # Colours have no alpha: it is 1.
        if colors is not None:
            colors = np.concatenate([colors, np.ones((vertices, 1), np.float32)], axis=1)
        return Geometry(
            positions.astype(np.float32),
            indices.astype(np.uint32),
            normals=None if normals is None else normals.astype(np.float32),
            uvs=None if uvs is None else uvs.astype(np.float32),
            colors=None if colors is None else colors.astype(np.float32),
        )

    def unpack(self, layout: str) -> tuple[int, ...]:
        values = struct.unpack_from(layout, self.data, self.at)
        self.at += struct.calcsize(layout)
        return values

    def rows(self, dtype: str, count: int, width: int) -> NDArray[Any]:
        """(count, width) numbers. ValueError where the data are too short for them."""
        size = count * width * np.dtype(dtype).itemsize
        if self.at + size > len(self.data):
            raise ValueError(f"it ends after {len(self.data)} bytes of {self.at + size}")
        values = np.frombuffer(self.data, dtype, count * width, self.at)
        self.at += size
        return values.reshape(count, width)
