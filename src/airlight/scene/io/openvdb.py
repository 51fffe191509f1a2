"""OpenVDB files (.vdb): header, grid descriptors, metadata and transforms.

Source: the OpenVDB library's file format, versions 222 (2013) to 224, which each of its releases
since 2.0 writes. `openvdb_tree` reads the voxels. No wheel of the library is kept up, and the
package tinyvdb leaves tiles out, so it is read here; Blosc needs the package blosc.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError, nearest
from ..checks import F64
from .dense_grid import HOW
from .files import read_bytes
from .nanovdb import SparseGrid
from .openvdb_tree import VdbError, VdbStream, read_tree

_MAGIC = 0x56444220
_OLDEST = 222
_NEWEST = 224
_UUID_BYTES = 36
_MOST_METADATA = 65536
_SUFFIX = "\x1e"  # OpenVDB adds it, and a number, to names that a file holds twice
_VECTOR = 3


@dataclass(frozen=True)
class _Descriptor:
    """What the file's head says of a grid."""

    name: str
    kind: str
    parent: str
    at: int
    blocks: int
    end: int


def read_openvdb(path: Path, wanted: str) -> SparseGrid:
    """The grid called `wanted`; the only one, where there is only one.

    Raises SceneError for what is no .vdb of version 222 to 224, is damaged, has no such grid, or
    is packed by Blosc where that is not installed.
    """
    raw = read_bytes(path)
    try:
        stream = VdbStream(raw)
        _check_head(stream)
        found = _descriptors(stream)
        names = [grid.name for grid in found]
        # Of several grids one has to be named.
        if len(found) != 1 and wanted not in names:
            raise SceneError(f"has no grid '{wanted}'", remedy=nearest(wanted, names) + HOW)
        chosen = found[0] if len(found) == 1 else found[names.index(wanted)]
        return _grid(stream, chosen, found)
    except (VdbError, struct.error, UnicodeDecodeError, OverflowError) as error:
        raise SceneError(
            f"is not a readable .vdb: {error}", remedy="Copy or export it again."
        ) from None


def openvdb_names(path: Path) -> list[str]:
    """The grids of a file. Raises SceneError for what is no .vdb that is read."""
    try:
        stream = VdbStream(read_bytes(path))
        _check_head(stream)
        return [grid.name for grid in _descriptors(stream)]
    except (VdbError, struct.error, UnicodeDecodeError, OverflowError) as error:
        raise SceneError(
            f"is not a readable .vdb: {error}", remedy="Copy or export it again."
        ) from None


def _check_head(stream: VdbStream) -> None:
    """Raise SceneError for a head that is none of a .vdb file which is read; else go past it."""
    magic, version = stream.unpack("<qI")
    if magic != _MAGIC:
        raise SceneError("is not a .vdb: it does not begin as one")
    if not _OLDEST <= version <= _NEWEST:
        raise SceneError(
            f"is of OpenVDB's file version {version}, {_OLDEST} to {_NEWEST} are read",
            remedy="Write it again with an OpenVDB of 2013 or newer.",
        )
    stream.unpack("<II")  # version of the library
    (has_offsets,) = stream.unpack("<B")
    if not has_offsets:
        raise SceneError(
            "is a .vdb stream without offsets of its grids", remedy="Write it to a file instead."
        )
    # Id and metadata of the file are passed over.
    stream.take(_UUID_BYTES)
    _metadata(stream)


def _descriptors(stream: VdbStream) -> list[_Descriptor]:
    """The grids, in the file's order, by the names that their authors gave."""
    (count,) = stream.unpack("<I")
    found = []
    for _ in range(count):
        # A descriptor, and where its grid begins, where its values do, and where it ends.
        name, kind, parent = (stream.text() for _ in range(3))
        at, blocks, end = stream.unpack("<3q")
        if not 0 <= at <= end <= len(stream.data) or not at <= blocks <= end:
            raise VdbError(f"grid '{name}' lies outside of the file")
        found.append(_Descriptor(name.split(_SUFFIX)[0], kind, parent, at, blocks, end))
        stream.at = end
    return found


def _metadata(stream: VdbStream) -> dict[str, bytes]:
    """Entries by name, as bytes: their types matter to none that is used here."""
    (count,) = stream.unpack("<I")
    if count > _MOST_METADATA:
        raise VdbError(f"{count:,} entries of metadata")
    entries = {}
    for _ in range(count):
        name, _ = stream.text(), stream.text()
        entries[name] = stream.sized()
    return entries


def _grid(stream: VdbStream, chosen: _Descriptor, found: list[_Descriptor]) -> SparseGrid:
    """A grid's values and place; an instance has the tree of its parent."""
    # Its head, and where it lies.
    stream.at = chosen.at
    (compression,) = stream.unpack("<I")
    metadata = _metadata(stream)
    world_from_index = _transform(stream)
    # An instance has the values of its parent.
    source = chosen
    if chosen.parent:
        parents = [g for g in found if g.name == chosen.parent.split(_SUFFIX)[0]]
        if not parents or parents[0].parent:
            raise VdbError(f"'{chosen.name}' shows '{chosen.parent}', which it does not hold")
        source = parents[0]
        # The parent's own head is passed over, as the instance has its own metadata and place.
        stream.at = source.at
        (compression,) = stream.unpack("<I")
        _metadata(stream)
        _transform(stream)
    values, first = read_tree(stream, source.kind, compression, source.end)
    # Zeros in place of voxels are no distances.
    is_level_set = metadata.get("class") == b"level set" and bool(values.any())
    return SparseGrid(values, first, world_from_index, is_level_set, chosen.name)


def _transform(stream: VdbStream) -> F64:
    """(4, 4) world from index. The library stores row vectors' matrices."""
    # Each kind of map stores its own numbers.
    kind = stream.text()
    matrix = np.eye(4)
    if kind in ("AffineMap", "UnitaryMap"):
        matrix = np.array(stream.unpack("<16d")).reshape(4, 4).T
    elif kind == "TranslationMap":
        matrix[:3, 3] = stream.unpack("<3d")
    elif kind in ("ScaleMap", "UniformScaleMap"):
        matrix[:3, :3] = np.diag(stream.unpack("<3d"))
        stream.unpack(f"<{4 * _VECTOR}d")  # voxel size, inverses
    elif kind in ("ScaleTranslateMap", "UniformScaleTranslateMap"):
        matrix[:3, 3] = stream.unpack("<3d")
        matrix[:3, :3] = np.diag(stream.unpack("<3d"))
        stream.unpack(f"<{4 * _VECTOR}d")
    else:
        raise SceneError(
            f"has a grid placed by a {kind}, which is no affine transform",
            remedy="Resample it onto a regular grid.",
        )
    # A flat transform has no inverse, and nothing in it volume.
    if not np.isfinite(matrix).all() or abs(float(np.linalg.det(matrix[:3, :3]))) < 1e-30:
        raise VdbError("a grid's transform is not finite, or flat")
    return matrix
