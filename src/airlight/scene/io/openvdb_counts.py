"""Counts in an OpenVDB file that its size cannot justify: tinyvdb allocates what they ask for."""

from __future__ import annotations

import os
import struct
from pathlib import Path
from typing import BinaryIO

from ...errors import SceneError
from .files import opened

_COUNTS_AT = 57  # behind magic number, versions, a flag and 36 letters of a UUID
_OLDEST_KNOWN = 222  # file versions that begin like that
_GRID_BYTES = 3 * 4 + 3 * 8  # at least: three texts, three offsets
_TILE_BYTES, _CHILD_BYTES = 17, 12  # of a root: origin and value, origin alone
_MOST_METADATA = 65536  # tinyvdb reads none of so many
_VECTOR = 3 * 8
_MAP_BYTES = {
    b"AffineMap": 128,
    b"UnitaryMap": 128,
    b"TranslationMap": _VECTOR,
    b"ScaleMap": 5 * _VECTOR,
    b"UniformScaleMap": 5 * _VECTOR,
    b"ScaleTranslateMap": 6 * _VECTOR,
    b"UniformScaleTranslateMap": 6 * _VECTOR,
}


def check_counts(path: Path) -> None:
    """Raise SceneError where the file is too short for its grids, or a grid's root for its nodes.

    Whatever else is wrong with a file is left to tinyvdb to say.
    """
    with opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        try:
            _walk(file, size)
        except (struct.error, EOFError):
            return


def _walk(file: BinaryIO, size: int) -> None:
    """Through the header and each grid's root."""
    _, version = struct.unpack("<qI", file.read(12))
    if version < _OLDEST_KNOWN:
        return
    file.seek(_COUNTS_AT)
    _skip_metadata(file, size)
    grids = _whole(file)
    _fits(grids, _GRID_BYTES, "grids", size - file.tell())
    for _ in range(grids):
        _text(file, size)
        kind = _text(file, size)
        parent = _text(file, size)
        at, _, end = struct.unpack("<3q", file.read(24))
        if not file.tell() <= at <= end <= size:  # each byte is looked at once
            return
        if not parent and kind.startswith(b"Tree_float_5_4_3"):
            file.seek(at)
            _check_root(file, end)
        file.seek(end)


def _check_root(file: BinaryIO, size: int) -> None:
    """From a grid's compression flags on: metadata, where it is, then its tree."""
    file.seek(4, os.SEEK_CUR)
    _skip_metadata(file, size)
    placed = _MAP_BYTES.get(_text(file, size))
    if placed is not None:
        file.seek(placed + 8, os.SEEK_CUR)  # number of buffers, background
        _fits(_whole(file), _TILE_BYTES, "tiles", size - file.tell())
        _fits(_whole(file), _CHILD_BYTES, "nodes", size - file.tell())


def _skip_metadata(file: BinaryIO, size: int) -> None:
    """Entries of name, type and value, each with its length before it."""
    count = _whole(file)
    if count > _MOST_METADATA:
        raise EOFError
    for _ in range(3 * count):
        _text(file, size)


def _fits(count: int, each: int, what: str, left: int) -> None:
    """Raise SceneError where so many things of `each` bytes or more are not in what is left."""
    if count * each > left:
        raise SceneError(f"is not a readable .vdb: {count:,} {what} do not fit in {left:,} bytes")


def _whole(file: BinaryIO) -> int:
    return int(struct.unpack("<I", file.read(4))[0])


def _text(file: BinaryIO, size: int) -> bytes:
    """Bytes behind their number; EOFError where the file has fewer."""
    count = _whole(file)
    if count > size - file.tell():
        raise EOFError
    return file.read(count)
