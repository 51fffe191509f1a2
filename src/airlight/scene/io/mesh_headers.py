"""What the headers of PLY and STL files claim, held against the files' sizes."""

from __future__ import annotations

import re
import struct
from pathlib import Path

from ...errors import SceneError

_STL_HEADER, _STL_COUNT, _STL_TRIANGLE = 80, struct.Struct("<I"), 50
_PLY_HEADER_BYTES = 1 << 16
_PLY_LINE = re.compile(rb"^(element|property)\b[ \t]*(.*?)[ \t\r]*$", re.M)


def check_counts(raw: bytes, kind: str, path: Path) -> None:
    """Raise SceneError where a "ply" or "stl" file claims more than its bytes can hold."""
    if kind == "stl":
        _check_stl(raw, path)
    elif kind == "ply":
        _check_ply(raw, path)


def _check_stl(raw: bytes, path: Path) -> None:
    # A binary file is as long as its count of triangles says, to the byte.
    start = _STL_HEADER + _STL_COUNT.size
    if len(raw) >= start:
        (count,) = _STL_COUNT.unpack_from(raw, _STL_HEADER)
        if len(raw) == start + count * _STL_TRIANGLE:
            return
        # Of another length it is text, or damaged.
        if _is_ascii_stl(raw):
            return
        raise SceneError(
            f"its header says {count:,} triangles, which take {start + count * _STL_TRIANGLE:,} "
            f"bytes; it has {len(raw):,}",
            where=path,
            remedy="Export it again.",
        )
    if not _is_ascii_stl(raw):
        raise SceneError("it has no triangles: it is too short for an STL file", where=path)


def _is_ascii_stl(raw: bytes) -> bool:
    # ASCII files begin with "solid", as some binary ones do; those hold zero bytes.
    if raw.lstrip()[:5].lower() != b"solid":
        return False
    try:
        raw.decode("utf-8")
    except UnicodeDecodeError:
        return b"facet" in raw and b"\0" not in raw
    return b"\0" not in raw


def _check_ply(raw: bytes, path: Path) -> None:
    end = raw.find(b"end_header", 0, _PLY_HEADER_BYTES)
    if end < 0:
        raise SceneError("not a readable PLY file (it has no header)", where=path)
    # The fewest bytes that an element can take: one for each property.
    needed, rows = 0, 0
    # The bound is checked as the header goes on: a huge count is refused at its first property.
    for keyword, rest in _PLY_LINE.findall(raw[:end]):
        if keyword == b"element":
            words = rest.split()
            if len(words) != 2 or not re.fullmatch(rb"\d{1,18}", words[1]):
                raise SceneError("its header has an element without a count", where=path)
            rows = int(words[1])
        # Each property takes a byte of every row at the least.
        needed += rows if keyword == b"property" else 0
        if needed > len(raw) - end or rows > len(raw):
            raise SceneError(
                f"its header says {rows:,} elements, more than its {len(raw):,} bytes can hold",
                where=path,
                remedy="Export it again.",
            )
