"""VTK's image data (.vti): regular grids as ParaView, PyVista and many simulations write them.

Source: VTK's XML file formats, versions 0.1 to 2.3. Values may be ASCII, base64 or appended (raw or
base64), packed by zlib or LZMA. The package vtk would bring 300 MB for this one format, and meshio
has no reader of it.
"""

from __future__ import annotations

import lzma
import math
import re
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, BinaryIO
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import Bounds
from .dense_grid import DenseGrid, box_of, check_count, chosen_name, without_missing
from .files import opened, read_bytes
from .vti_values import TYPES, VtiFile, values_of

_APPENDED = re.compile(rb"<AppendedData\b([^>]*)>")
_LONGEST_HEAD = 1 << 20  # bytes of XML before appended data
_FIELD_END = b"</FieldData>"
_ONE_VALUE = 4096  # bytes: more than one number takes, packed or not; whole groups of base64
_LIKELY = ("density", "Density", "smoke", "rho")


@dataclass(frozen=True)
class _Array:
    """A named array: of points or cells, and its element in each piece."""

    name: str
    is_of_points: bool
    pieces: list[tuple[NDArray[np.int64], ElementTree.Element]]


def read_vti(path: Path, wanted: str) -> DenseGrid:
    """The array called `wanted`; of "density", the active scalars or the only array.

    Raises SceneError for what is damaged, packed by LZ4, or has no such array.
    """
    try:
        # The head and where values lie; values are unpacked for the wanted array alone.
        file = _parsed(read_bytes(path))
        arrays, active = _arrays(file.image)
        name = chosen_name(wanted, list(arrays), (*_LIKELY, *active))
        warned = () if name == wanted else (f"{path.name}: its array '{name}' is the density",)
        grid = _grid(file, arrays[name], warned)
        flat = " and ".join(a for a, n in zip("zyx", grid.values.shape, strict=False) if n == 1)
        told = (f"{path.name} is flat: it has one layer along {flat}",) if flat else ()
        values, missed = without_missing(grid.values, name, path.name)
        return replace(grid, values=values, warnings=(*warned, *told, *missed))
    except (ElementTree.ParseError, KeyError, ValueError, zlib.error, lzma.LZMAError) as error:
        raise SceneError(
            f"is not a readable .vti: {error}", remedy="Copy or export it again."
        ) from None


def vti_names(path: Path) -> list[str]:
    """The arrays of a file. Raises SceneError for what is no .vti that is read."""
    try:
        return list(_arrays(_parsed(read_bytes(path)).image)[0])
    except (ElementTree.ParseError, KeyError, ValueError) as error:
        raise SceneError(
            f"is not a readable .vti: {error}", remedy="Copy or export it again."
        ) from None


def vti_time(path: Path) -> float | None:
    """When a file says it is of: its TimeValue, in whatever unit it has; None where it says none.

    Of a file of any size no more than its head is read. Raises SceneError for what is no .vti.
    """
    try:
        with opened(path) as stream:
            raw = stream.read(_LONGEST_HEAD)
            end = raw.find(_FIELD_END)
            if end < 0:
                return None
            # What stands before the pieces, as a file of its own.
            file = _parsed(raw[: end + len(_FIELD_END)] + b"</ImageData></VTKFile>")
            element = file.image.find("FieldData/DataArray[@Name='TimeValue']")
            if element is None:
                return None
            if element.get("format") == "appended":
                file = replace(file, **_appended(stream, raw, int(element.get("offset", "0"))))
                element.set("offset", "0")
            found = float(values_of(file, element, 1)[0])
    except (ElementTree.ParseError, KeyError, ValueError, zlib.error, lzma.LZMAError):
        return None
    return found if math.isfinite(found) else None


def _appended(stream: BinaryIO, raw: bytes, offset: int) -> dict[str, Any]:
    """The first of the appended data from `offset` on, and whether they are raw; `raw`: the head.

    Raises ValueError where the head has not ended yet.
    """
    found = _APPENDED.search(raw)
    begin = -1 if found is None else raw.find(b"_", found.end())
    if found is None or begin < 0:
        raise ValueError("its head is too long")
    stream.seek(begin + 1 + offset)
    is_raw, data = b"raw" in found[1], stream.read(_ONE_VALUE)
    return {"appended": data if is_raw else data.partition(b"<")[0], "is_raw": is_raw}


class _Builder(ElementTree.TreeBuilder):
    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        raise SceneError("a document type (<!DOCTYPE ...>) is refused", remedy="Remove it.")


def _parsed(raw: bytes) -> VtiFile:
    """The file without its appended data, which need not be XML, and those."""
    # Appended data may be raw bytes, which no XML parser takes: cut off first.
    found = _APPENDED.search(raw)
    appended, is_raw = b"", False
    if found:
        if found.start() > _LONGEST_HEAD:
            raise ValueError("its head is too long")
        begin = raw.find(b"_", found.end())
        if begin < 0:
            raise ValueError("its appended data do not begin with an underscore")
        appended, is_raw = raw[begin + 1 :], b"raw" in found[1]
        # Base64 ends at the next tag; raw bytes may hold any sign.
        if not is_raw:
            appended = appended.partition(b"<")[0]
        raw = raw[: found.start()] + b"</VTKFile>"
    # What remains is XML, in which entities are refused.
    parser = ElementTree.XMLParser(target=_Builder())
    parser.feed(raw)
    root = parser.close()
    image = root.find("ImageData")
    if root.tag != "VTKFile" or image is None:
        kind = root.get("type") or root.tag
        raise SceneError(
            f"is of VTK's type {kind}, only ImageData is read",
            remedy="Resample it to an image in ParaView, or by vtkResampleToImage.",
        )
    # How numbers are stored in all of the file.
    order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    header = TYPES[root.get("header_type", "UInt32")]
    return VtiFile(image, order, order + header, root.get("compressor", ""), appended, is_raw)


def _arrays(image: ElementTree.Element) -> tuple[dict[str, _Array], list[str]]:
    """Arrays of numbers by name, those of points first, and the names of active scalars."""
    found: dict[str, _Array] = {}
    active = []
    # Points are read before cells, because a name in both is taken from points.
    for kind in ("PointData", "CellData"):
        for piece in image.findall("Piece"):
            extent = _numbers(piece, "Extent", 6, int)
            for data in piece.findall(kind):
                active.append(data.get("Scalars", ""))
                for element in data.findall("DataArray"):
                    name = element.get("Name", "")
                    array = found.setdefault(name, _Array(name, kind == "PointData", []))
                    if array.is_of_points == (kind == "PointData"):
                        array.pieces.append((extent, element))
    return found, active


def _grid(file: VtiFile, array: _Array, warned: tuple[str, ...]) -> DenseGrid:
    """All pieces of an array in one grid, and its place."""
    # The whole image, of which each piece says its part.
    whole = _numbers(file.image, "WholeExtent", 6, int)
    count = _counts(whole, array.is_of_points)
    channels = int(array.pieces[0][1].get("NumberOfComponents", "1"))
    check_count(math.prod(count) * channels)
    values: NDArray[Any] | None = None
    # Pieces are boxes of the whole, in any order; they may share a layer of points.
    for extent, element in array.pieces:
        own = _counts(extent, array.is_of_points)
        first = extent[::2] - whole[::2]
        if (first < 0).any() or any(a + n > m for a, n, m in zip(first, own, count, strict=True)):
            raise ValueError(f"a piece of '{array.name}' lies outside of the whole")
        flat = values_of(file, element, math.prod(own) * channels)
        # x is fastest in the file, as in the grid.
        block = flat.reshape(*own[::-1], channels)
        # The first piece says of which type the whole is.
        if values is None:
            values = np.zeros((*count[::-1], channels), block.dtype)
        x, y, z = (slice(int(a), int(a) + n) for a, n in zip(first, own, strict=True))
        values[z, y, x] = block
    assert values is not None
    box, matrix = _place(file.image, whole, array.is_of_points)
    shown = values[..., 0] if channels == 1 else values
    downwards = tuple(2 - k for k in range(3) if _spacing(file.image)[k] < 0.0)
    return DenseGrid(np.flip(shown, downwards), box, matrix, warned)


def _counts(extent: NDArray[np.int64], is_of_points: bool) -> tuple[int, int, int]:
    """Values along x, y and z; a flat image has one layer of cells."""
    x, y, z = (int(n) for n in extent[1::2] - extent[::2])
    if min(x, y, z) < 0:
        raise ValueError("an extent ends before it begins")
    more = 1 if is_of_points else 0
    return max(x + more, 1), max(y + more, 1), max(z + more, 1)


def _place(
    image: ElementTree.Element, whole: NDArray[np.int64], is_of_points: bool
) -> tuple[Bounds, NDArray[np.float64]]:
    """The box in the image's own axes, and the matrix from there. Points are voxels' centres."""
    origin = _numbers(image, "Origin", 3, float, "0 0 0")
    spacing = _spacing(image)
    turn = _numbers(image, "Direction", 9, float, "1 0 0 0 1 0 0 0 1").reshape(3, 3)
    half = 0.5 if is_of_points else 0.0
    # Points are the centres of voxels, so the box reaches half a spacing beyond them;
    # points may follow each other downwards.
    first = spacing * (whole[::2] - half)
    last = spacing * (np.maximum(whole[1::2], whole[::2] + (not is_of_points)) + half)
    low, high = np.minimum(first, last), np.maximum(first, last)
    matrix = np.eye(4)
    # A turned image keeps its own axes, and a matrix leads to the world.
    if np.array_equal(turn, np.eye(3)):
        low, high = low + origin, high + origin
    else:
        matrix[:3, :3], matrix[:3, 3] = turn, origin
    return box_of(low, high, "Write its Spacing and Origin"), matrix


def _spacing(image: ElementTree.Element) -> NDArray[np.float64]:
    """Metres from point to point along x, y and z; below 0 where they follow downwards."""
    spacing = _numbers(image, "Spacing", 3, float, "1 1 1")
    if (spacing == 0.0).any():
        how = "Write how far its points are from each other along x, y and z."
        raise SceneError(f"its Spacing '{image.get('Spacing')}' has a 0", remedy=how)
    return spacing


def _numbers(
    element: ElementTree.Element, name: str, count: int, kind: type, usual: str = ""
) -> NDArray[Any]:
    values = np.array([kind(part) for part in element.get(name, usual).split()])
    if len(values) != count:
        raise ValueError(f"its {name} has {len(values)} numbers, not {count}")
    return values
