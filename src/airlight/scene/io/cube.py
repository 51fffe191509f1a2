"""Reads lookup tables of colours: .cube files (Adobe's Cube LUT Specification 1.0)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import SceneError
from ...maths.arrays import F64
from ...maths.lut import Lut
from .files import read_bytes

_MOST = {"LUT_1D_SIZE": 65536, "LUT_3D_SIZE": 256}
_REMEDY = "Export it again as .cube from the application that made it."


def read_cube(path: Path) -> Lut:
    """The table in a .cube file, of one dimension or three. Raises SceneError."""
    lines = read_bytes(path).decode("utf-8", "replace").splitlines()
    kind, size = "", 0
    ends = {"DOMAIN_MIN": np.zeros(3), "DOMAIN_MAX": np.ones(3)}
    rows: list[F64] = []
    # Lines are keywords or rows of three numbers, in any order.
    for number, line in enumerate(lines, 1):
        words = line.split("#")[0].split()
        if not words or words[0] == "TITLE":
            continue
        if words[0] in _MOST:
            kind, size = words[0], _size(path, number, words)
        elif words[0] in ends:
            ends[words[0]] = _numbers(path, number, words[1:], 3)
        elif words[0] in ("LUT_1D_INPUT_RANGE", "LUT_3D_INPUT_RANGE"):  # DaVinci Resolve's
            low, high = _numbers(path, number, words[1:], 2)
            ends = {"DOMAIN_MIN": np.full(3, low), "DOMAIN_MAX": np.full(3, high)}
        else:
            rows.append(_numbers(path, number, words, 3))
    # The rows are counted only now, as the size may stand after them.
    return _table(path, kind, size, ends, rows)


def _table(path: Path, kind: str, size: int, ends: dict[str, F64], rows: list[F64]) -> Lut:
    if not kind:
        raise SceneError("it says no LUT_1D_SIZE or LUT_3D_SIZE", where=path, remedy=_REMEDY)
    # Of three dimensions, the size is that of each side.
    wanted = size if kind == "LUT_1D_SIZE" else size**3
    if len(rows) != wanted:
        raise SceneError(
            f"{kind} {size} means {wanted} colours; it has {len(rows)}", where=path, remedy=_REMEDY
        )
    # Each channel has a domain of its own.
    low, high = ends["DOMAIN_MIN"], ends["DOMAIN_MAX"]
    if not (high > low).all():
        raise SceneError("DOMAIN_MAX is not above DOMAIN_MIN", where=path, remedy=_REMEDY)
    table = np.array(rows)
    if kind == "LUT_3D_SIZE":
        # Red changes fastest.
        table = table.reshape(size, size, size, 3).transpose(2, 1, 0, 3)
    return Lut(np.ascontiguousarray(table), low, high)


def _size(path: Path, number: int, words: list[str]) -> int:
    most = _MOST[words[0]]
    if len(words) != 2 or not words[1].isdecimal() or not 2 <= int(words[1]) <= most:
        said = " ".join(words)
        raise SceneError(
            f"line {number}: '{said}' is no size from 2 to {most}", where=path, remedy=_REMEDY
        )
    return int(words[1])


def _numbers(path: Path, number: int, words: list[str], count: int) -> F64:
    # Text that is no number fails the count below, with one message for both.
    try:
        values = np.array([float(word) for word in words])
    except ValueError:
        values = np.zeros(0)
    if len(values) != count or not np.isfinite(values).all():
        said = " ".join(words)[:60]
        raise SceneError(
            f"line {number}: '{said}' is not {count} numbers", where=path, remedy=_REMEDY
        )
    return values
