"""The text of an OBJ file as arrays: every statement of one kind is parsed in one go.

A file is tens of megabytes of four kinds of line (v, vt, vn, f). The lines of one kind are cut
out of the bytes with a mask and handed to NumPy's C number parser as one block; how many
numbers each line had is counted from the same bytes. Only the few other statements
(usemtl, mtllib, s) are read line by line.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ...maths.arrays import F64, I64, U8
from .number_blocks import NEWLINE, SPACE, parsed, rows_of, slashes_per_token, token_counts

_V, _VT, _VN, _FACE, _OTHER = 1, 2, 3, 4, 0
_LEFT_OUT = ("p", "l", "curv", "surf", "call", "maplib", "usemap", "bevel")
_KIND_NAMES = {_V: "v", _VT: "vt", _VN: "vn", _FACE: "f"}


@dataclass(frozen=True, eq=False)
class ObjData:
    """What an OBJ file says, indices 0-based and -1 where a corner has none.

    `positions` (P, 3), `colors` (P, 3) sRGB-encoded or None, `uvs` (U, 2) with v upwards,
    `normals` (N, 3) float64; `corners` (C, 3) position, uv and normal index of each polygon
    corner; per polygon `sizes`, `lines` (1-based), `material` (into `material_names`) and
    `is_flat` (smoothing is off). `unread`: keywords of statements that mean something and are left
    out. `absent`: those that corners name the indices of, and of which there is none.
    """

    positions: F64
    colors: F64 | None
    uvs: F64
    normals: F64
    corners: I64
    sizes: I64
    lines: I64
    material: I64
    is_flat: NDArray[np.bool_]
    material_names: tuple[str, ...]
    libraries: tuple[str, ...]
    unread: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()


def parse_obj(raw: bytes, path: Path) -> ObjData:
    """Parse the bytes of an OBJ file. Raises SceneError naming `path` and the line."""
    # Numbers of all lines of a kind at once.
    lines = _Lines(raw, path)
    points, point_sizes = lines.numbers(_V)
    uvs, uv_sizes = lines.numbers(_VT)
    normals, normal_sizes = lines.numbers(_VN)
    # Faces, their negative indices counted from the line they stand on.
    corners, sizes = lines.corners()
    face_lines = lines.of(_FACE)
    absent = []
    for column, kind in enumerate((_V, _VT, _VN)):
        # Indices of texture coordinates or normals of which there are none are dropped.
        if kind != _V and not len(lines.of(kind)) and corners[:, column].any():
            absent.append(_KIND_NAMES[kind])
            corners[:, column] = 0  # as if the faces did not name them
        _resolve(corners[:, column], sizes, face_lines, lines.of(kind), kind, path)
    # Materials and smoothing hold from their line until the next.
    statements = _Statements(lines)
    return ObjData(
        positions=lines.columns(points, point_sizes, 3, _V),
        colors=lines.colors(points, point_sizes),
        uvs=lines.columns(uvs, uv_sizes, 2, _VT),
        normals=lines.columns(normals, normal_sizes, 3, _VN),
        corners=corners,
        sizes=sizes,
        lines=face_lines + 1,
        material=statements.material_at(face_lines),
        is_flat=statements.is_flat_at(face_lines),
        material_names=tuple(statements.material_names),
        libraries=tuple(statements.libraries),
        unread=_unread(lines),
        absent=tuple(absent),
    )


class _Lines:
    """The lines of the file, sorted by kind."""

    def __init__(self, raw: bytes, path: Path) -> None:
        self.path = path
        # Other white space and line ends become spaces and newlines, so that masks find words.
        text = raw.translate(bytes.maketrans(b"\t\f\v", b"   "))
        text = text.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        # A continued line keeps its length in bytes, but its parts become one line.
        text = text.replace(b"\\\n", b"  ")
        text = re.sub(rb"(?m)^ +", b"", text) + b"\n\n"
        self.data: U8 = np.frombuffer(text, dtype=np.uint8).copy()
        # Where each line begins and ends, and by its first three bytes of which kind it is.
        ends = np.flatnonzero(self.data == NEWLINE)[:-1]
        self.starts: I64 = np.concatenate([[0], ends[:-1] + 1]).astype(np.int64)
        self.ends: I64 = ends.astype(np.int64)
        first, second = self.data[self.starts], self.data[self.starts + 1]
        third = self.data[np.minimum(self.starts + 2, len(self.data) - 1)]
        vertex, spaced = first == ord("v"), second == SPACE
        self.kind = np.zeros(len(self.starts), dtype=np.uint8)
        self.kind[vertex & spaced] = _V
        self.kind[vertex & (second == ord("t")) & (third == SPACE)] = _VT
        self.kind[vertex & (second == ord("n")) & (third == SPACE)] = _VN
        self.kind[(first == ord("f")) & spaced] = _FACE

    def of(self, kind: int) -> I64:
        """0-based numbers of the lines of a kind."""
        return np.flatnonzero(self.kind == kind)

    def text(self, kind: int) -> bytes:
        """The lines of a kind, one after the other, without keyword and comments."""
        data = self.data.copy()
        starts = self.starts[self.kind == kind]
        # The keyword becomes blanks, which the number parser skips.
        data[starts] = SPACE
        if kind in (_VT, _VN):
            data[starts + 1] = SPACE
        mask = np.repeat(self.kind == kind, self.ends - self.starts + 1)
        block = data[: len(mask)][mask].tobytes()
        return re.sub(rb"#[^\n]*", b"", block) if b"#" in block else block

    def numbers(self, kind: int) -> tuple[F64, I64]:
        """All numbers on the lines of a kind, and how many stand on each."""
        text = self.text(kind)
        sizes = token_counts(text)
        values = parsed(text, np.float64)
        if values is None or len(values) != sizes.sum():
            raise self._unreadable(kind, text)
        return values, sizes

    def columns(self, values: F64, sizes: I64, width: int, kind: int) -> F64:
        """The first `width` numbers of every line of a kind, (n, width), all finite."""
        short = np.flatnonzero(sizes < (1 if kind == _VT else width))
        if len(short):
            self._fail(kind, int(short[0]), f"has {sizes[short[0]]} numbers, not {width}")
        if kind == _VT and (sizes < width).any():
            # `vt u` alone is a one-dimensional texture coordinate; v is 0.
            first = np.cumsum(sizes) - sizes
            second = np.where(sizes > 1, values[np.minimum(first + 1, len(values) - 1)], 0.0)
            rows = np.stack([values[first], second], axis=1)
        else:
            rows = rows_of(values, sizes, 0, width)
        # Geometries keep them in single precision, where they have to be finite, too.
        with np.errstate(over="ignore"):
            bad = np.flatnonzero(~np.isfinite(rows.astype(np.float32)).all(axis=1))
        if len(bad):
            self._fail(kind, int(bad[0]), "holds a number that is NaN or infinite")
        return rows

    def colors(self, values: F64, sizes: I64) -> F64 | None:
        """Vertex colours written after the position (`v x y z r g b`), (n, 3), or None."""
        if len(sizes) == 0 or sizes.min() < 6:
            return None
        return np.nan_to_num(rows_of(values, sizes, 3, 3))

    def corners(self) -> tuple[I64, I64]:
        """Corners of all polygons (C, 3) as written, 0 where absent; and corners per polygon."""
        # Every corner as a/b/c, with 0 for what it leaves out.
        # A corner may end in slashes without an index.
        text = self.text(_FACE)
        if b"/\n" in text or b"/ " in text:
            text = re.sub(rb"/+(?=[ \n])", b"", text)
        text = text.replace(b"//", b"/0/")
        sizes = token_counts(text)
        values = parsed(text.replace(b"/", b" "), np.int64)
        # How many numbers each corner has says where the next one begins.
        slashes = slashes_per_token(text)
        if values is None or len(values) != len(slashes) + slashes.sum() or (slashes > 2).any():
            raise self._unreadable(_FACE, text.replace(b"/", b" "))
        # A corner has one number, and one more after each slash.
        first = np.cumsum(slashes + 1) - (slashes + 1)
        last = len(values) - 1
        corners = np.zeros((len(first), 3), dtype=np.int64)
        corners[:, 0] = values[first]
        for column in (1, 2):
            given = values[np.minimum(first + column, last)]
            corners[:, column] = np.where(slashes >= column, given, 0)
        return corners, sizes

    def line_text(self, number: int) -> str:
        """One line, 0-based."""
        return (
            self.data[self.starts[number] : self.ends[number]].tobytes().decode("utf-8", "replace")
        )

    def _unreadable(self, kind: int, text: bytes) -> SceneError:
        """The error for the first line of the block `text` that is not numbers; slow, final."""
        whole = np.int64 if kind == _FACE else np.float64
        for row, line in enumerate(text.split(b"\n")):
            count = len(line.split())
            values = parsed(line, whole)
            if values is None or len(values) != count:
                return self._error(kind, row, "is not a list of numbers")
        return SceneError(f"its '{_KIND_NAMES[kind]}' lines cannot be read", where=self.path)

    def _fail(self, kind: int, row: int, problem: str) -> None:
        raise self._error(kind, row, problem)

    def _error(self, kind: int, row: int, problem: str) -> SceneError:
        number = int(self.of(kind)[row])
        shown = self.line_text(number).strip()[:60]
        return SceneError(f"'{shown}' {problem}", where=f"{self.path}, line {number + 1}")


class _Statements:
    """What usemtl, mtllib and s say, and from which line on."""

    def __init__(self, lines: _Lines) -> None:
        self.material_names: list[str] = [""]
        self.libraries: list[str] = []
        self._material_from = [(-1, 0)]
        self._flat_from = [(-1, 0)]
        # Of all other lines those that change the faces after them.
        known = {"": 0}
        first = lines.data[lines.starts]
        wanted = (lines.kind == _OTHER) & np.isin(first, np.frombuffer(b"ums", dtype=np.uint8))
        for number in np.flatnonzero(wanted).tolist():
            keyword, _, rest = lines.line_text(number).partition(" ")
            rest = rest.strip()
            if keyword == "usemtl":
                if rest not in known:
                    known[rest] = len(self.material_names)
                    self.material_names.append(rest)
                self._material_from.append((number, known[rest]))
            elif keyword == "mtllib":
                self.libraries.append(rest)
            elif keyword == "s":
                self._flat_from.append((number, int(rest in ("off", "0"))))

    def material_at(self, face_lines: I64) -> I64:
        return _latest(self._material_from, face_lines)

    def is_flat_at(self, face_lines: I64) -> NDArray[np.bool_]:
        return _latest(self._flat_from, face_lines).astype(bool)


def _unread(lines: _Lines) -> tuple[str, ...]:
    """The keywords of _LEFT_OUT that the file uses; others have no meaning for what is seen."""
    starts = lines.starts[lines.kind == _OTHER]
    last = len(lines.data) - 1
    # Of each distinct beginning one line is read: groups and comments may be millions.
    begins = np.stack([lines.data[np.minimum(starts + k, last)] for k in range(6)], axis=1)
    words = {
        row.tobytes().replace(b"\n", b" ").split(b" ")[0].decode("latin-1")
        for row in np.unique(begins, axis=0)
    }
    return tuple(word for word in _LEFT_OUT if word[:6] in words)


def _latest(changes: list[tuple[int, int]], at: I64) -> I64:
    numbers, values = np.array(changes, dtype=np.int64).T
    # The last change on a line before each face; every list begins with one at line -1.
    latest: I64 = values[np.searchsorted(numbers, at) - 1]
    return latest


def _resolve(
    written: I64, sizes: I64, face_lines: I64, kind_lines: I64, kind: int, path: Path
) -> None:
    """Turn 1-based and negative indices into 0-based ones in place; absent becomes -1."""
    lines = np.repeat(face_lines, sizes)
    absent = written == 0
    # -1 is the latest element before the face, so count how many had been written by then.
    before = np.searchsorted(kind_lines, lines)
    resolved = np.where(written < 0, before + written, written - 1)
    bad = (resolved < 0) | (resolved >= len(kind_lines))
    # A vertex always has a position; other indices may be absent.
    bad &= ~absent if kind != _V else True
    if bad.any():
        at = int(np.flatnonzero(bad)[0])
        raise SceneError(
            f"'{_KIND_NAMES[kind]}' index {written[at]} is out of range: "
            f"the file has {len(kind_lines)} of them",
            where=f"{path}, line {lines[at] + 1}",
        )
    written[:] = np.where(absent, -1, resolved)
