"""NanoVDB files (.nvdb): one grid of 32-bit floats as a dense array.

Source: the published layout of NanoVDB 32 (PNanoVDB.h): a file header, one record and one buffer
per grid; a buffer is a tree of root, 32^3, 16^3 and 8^3 nodes, each kind in one piece.
"""

from __future__ import annotations

import importlib
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, nearest
from ..checks import F32, F64
from .dense_grid import HOW
from .files import read_bytes

LARGEST_VOXEL_COUNT = 1 << 30
MODEST_VOXEL_COUNT = 1 << 24
"""Voxels that any file may span."""
VOXELS_PER_BYTE = 512
"""Voxels for each byte of a file that spans more: emptier ones hold next to nothing."""
MOST_UNPACKED = 1100
"""How many times as large deflated and blosc-packed bytes can become; zlib's own limit is 1032."""

_FILE = struct.Struct("<8sIHH")
_RECORD = struct.Struct("<4Q2I6d6i3dI4I3I2HI")
_MAGICS = (b"NanoVDB0", b"NanoVDB2")
_MAJOR = 32
_FLOAT, _LEVEL_SET = 1, 1
_UNPACKED, _ZIP, _BLOSC = 0, 1, 2
_LENGTH = struct.Struct("<Q")
_BLOSC_SIZES = struct.Struct("<4xIII")  # of a chunk's header: bytes unpacked, of a block, packed
_MAP_OFFSET, _TREE_OFFSET = 296, 672
_ROOT_TILE, _UPPER, _LOWER, _LEAF = (
    np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})
    for names, formats, offsets, size in (
        (["key", "child", "value"], ["<u8", "<i8", "<f4"], [0, 8, 20], 32),
        (["low", "table"], [("<i4", 3), ("<i8", (32, 32, 32))], [0, 8256], 270400),
        (["low", "table"], [("<i4", 3), ("<i8", (16, 16, 16))], [0, 1088], 33856),
        (["low", "values"], [("<i4", 3), ("<f4", (8, 8, 8))], [0, 96], 2144),
    )
)


@dataclass(frozen=True, eq=False)
class SparseGrid:
    """A VDB grid as a dense array.

    `values` (x, y, z) float32, of vectors (x, y, z, 3): the voxels from `first` (3,) on, background
    included.
    `world_from_index` (4, 4): voxel centres lie at whole numbers. `is_level_set`: values are
    signed distances, negative inside. `name`: the grid's own.
    """

    values: F32
    first: tuple[int, int, int]
    world_from_index: F64
    is_level_set: bool
    name: str = ""


def read_nanovdb(path: Path, wanted: str) -> SparseGrid:
    """The grid called `wanted`; the only one, where there is only one.

    Raises SceneError for what is damaged, packed by Blosc where that is not installed, or not of
    32-bit floats.
    """
    content = read_bytes(path)
    if len(content) < _FILE.size or content[:8] not in _MAGICS:
        raise SceneError("is not a NanoVDB file")
    # The major version says how nodes are laid out in memory, which is what the file holds.
    _, version, count, _ = _FILE.unpack_from(content)
    if version >> 21 != _MAJOR:
        raise SceneError(
            f"is of NanoVDB version {version >> 21}, only {_MAJOR} is read",
            remedy="Convert it with a newer nanovdb_convert.",
        )
    # Damage shows as any of these errors: offsets lead outside, or packed bytes do not unpack.
    try:
        record, buffer = _chosen(content, count, wanted)
        return _dense(record, buffer, len(content))
    except (struct.error, zlib.error, ValueError, IndexError, OverflowError) as error:
        raise SceneError(f"is damaged: {error}") from error


@dataclass(frozen=True)
class _Record:
    """What the file says of a grid."""

    kind: int
    grid_class: int
    low: tuple[int, int, int]
    high: tuple[int, int, int]
    name: str


def _chosen(content: bytes, count: int, wanted: str) -> tuple[_Record, bytes]:
    """Record and unpacked buffer of one grid."""
    at, names = _FILE.size, []
    found: tuple[_Record, bytes] | None = None
    # Grids follow each other, each with a record of its sizes before it.
    for _ in range(count):
        fields = _RECORD.unpack_from(content, at)
        size, packed_size, name_size, codec = fields[0], fields[1], fields[21], fields[29]
        at += _RECORD.size
        names.append(content[at : at + name_size].rstrip(b"\0").decode(errors="replace"))
        at += name_size
        # Of a single grid the name does not matter.
        if names[-1] == wanted or count == 1:
            record = _Record(fields[4], fields[5], fields[12:15], fields[15:18], names[-1])
            found = record, _unpacked(content[at : at + packed_size], size, codec)
        at += packed_size
    if found is None:
        raise SceneError(f"has no grid '{wanted}'", remedy=nearest(wanted, names) + HOW)
    return found


def _unpacked(packed: bytes, size: int, codec: int) -> bytes:
    if codec not in (_UNPACKED, _ZIP, _BLOSC):
        raise SceneError(f"is packed by a codec that is not known, {codec}")
    # Sizes are checked before anything is unpacked: a few bytes can claim gigabytes.
    if size > MOST_UNPACKED * len(packed) + _TREE_OFFSET:
        raise SceneError(f"is damaged: {len(packed):,} bytes cannot hold a grid of {size:,}")
    # One byte more is asked for than there should be, which shows a false size.
    if codec == _ZIP:
        stream = zlib.decompressobj()
        packed = stream.decompress(packed[8:], size + 1)
    elif codec == _BLOSC:
        packed = _without_blosc(packed, size)
    if len(packed) != size:
        raise SceneError(f"is cut short: {len(packed):,} of {size:,} bytes of a grid")
    return packed


def _without_blosc(packed: bytes, size: int) -> bytes:
    """Chunks of Blosc, each after its length; as far as they say that they fit into `size`."""
    try:
        blosc = importlib.import_module("blosc")
    except ImportError:
        raise SceneError(
            "is packed by Blosc, which needs the package blosc",
            remedy="Run: pip install 'airlight[vdb]', or convert it with nanovdb_convert --zip.",
        ) from None
    # Chunk after chunk, each checked against the rest of the size before it is unpacked.
    found, at, left = [], 0, size
    while left > 0:
        (length,) = _LENGTH.unpack_from(packed, at)
        at += _LENGTH.size
        # The chunk's own header repeats its length, and says to how much it unpacks.
        whole, _, said = _BLOSC_SIZES.unpack_from(packed, at)
        if whole > left or said != length or at + length > len(packed) or not whole:
            raise ValueError("a Blosc chunk of the wrong size")
        try:
            found.append(blosc.decompress(packed[at : at + length]))
        except blosc.blosc_extension.error as error:
            raise ValueError(error) from None
        at += length
        left -= whole
    return b"".join(found)


def check_span(size: NDArray[np.int64], file_bytes: int) -> None:
    """Raise SceneError for a box of more voxels than is possible, or than the file bears out."""
    voxels = int(np.prod(size.astype(object)))
    most = min(LARGEST_VOXEL_COUNT, max(MODEST_VOXEL_COUNT, VOXELS_PER_BYTE * file_bytes))
    if voxels > most:
        have = " x ".join(str(n) for n in size)
        raise SceneError(
            f"spans {have} voxels, too many for a file of {file_bytes:,} bytes"
            if voxels <= LARGEST_VOXEL_COUNT
            else f"spans {have} voxels, too many",
            remedy="Downsample it, or crop it to what it holds.",
        )


def _dense(record: _Record, buffer: bytes, file_bytes: int) -> SparseGrid:
    """The tree spread over the box of its active voxels."""
    # Quantised kinds keep other values than floats.
    if record.kind != _FLOAT:
        raise SceneError(
            f"holds values of NanoVDB's type {record.kind}, only 32-bit floats are read",
            remedy="Save the grid unquantised.",
        )
    # The size is checked before anything is made: a damaged head could ask for any.
    first, end = np.array(record.low), np.array(record.high) + 1
    if (end <= first).any():
        nothing = np.zeros((1, 1, 1), np.float32)
        return SparseGrid(nothing, (0, 0, 0), np.eye(4), False, record.name)
    check_span(end - first, file_bytes)
    # The map, and where each kind of node begins and how many there are.
    matrix, shift = (
        np.frombuffer(buffer, "<f8", n, _MAP_OFFSET + at) for n, at in ((9, 88), (3, 232))
    )
    offsets = np.frombuffer(buffer, "<i8", 4, _TREE_OFFSET) + _TREE_OFFSET
    counts = np.frombuffer(buffer, "<u4", 3, _TREE_OFFSET + 32)
    world_from_index = np.eye(4)
    world_from_index[:3, :3], world_from_index[:3, 3] = matrix.reshape(3, 3), shift
    # Blocks of 8^3 voxels over the active box: coarse values, then those of the leaves, then cut
    # to it.
    leaf, lower, upper = (
        np.frombuffer(buffer, kind, int(n), int(at))
        for kind, n, at in zip((_LEAF, _LOWER, _UPPER), counts, offsets, strict=False)
    )
    corner = first // 8
    blocks = _blocks(buffer, int(offsets[3]), corner, -(-end // 8) - corner, upper, lower)
    values = _with_leaves(blocks, corner, leaf)
    cut = tuple(slice(a, b) for a, b in zip(first - 8 * corner, end - 8 * corner, strict=True))
    return SparseGrid(
        np.ascontiguousarray(values[cut]),
        record.low,
        world_from_index,
        record.grid_class == _LEVEL_SET,
        record.name,
    )


def _blocks(
    buffer: bytes,
    root: int,
    corner: NDArray[np.int64],
    shape: NDArray[np.int64],
    upper: NDArray[np.void],
    lower: NDArray[np.void],
) -> F32:
    """Values of the 8^3 blocks from block `corner` on, of all that is coarser than leaves."""
    # From coarse to fine: the background, the root's tiles, then values of upper and lower nodes.
    tile_count, background = struct.unpack_from("<If", buffer, root + 24)
    blocks = np.full(shape, background, np.float32)
    tiles = np.frombuffer(buffer, _ROOT_TILE, tile_count, root + 64)
    for tile in tiles[tiles["child"] == 0]:
        key = int(tile["key"])
        low = [_signed(key >> shift) << 12 for shift in (42, 21, 0)]
        _paint(blocks, corner, np.array(low) // 8, tile["value"].reshape(1, 1, 1), 512)
    # Each table holds values where there is no child; those of children are painted over later.
    for nodes, side, bits in ((upper, 16, 12), (lower, 1, 7)):
        for node in nodes:
            low = node["low"].astype(np.int64) >> bits << bits
            table = np.ascontiguousarray(node["table"]).view("<f4")[..., ::2]
            _paint(blocks, corner, low // 8, table, side)
    return blocks


def _signed(bits: int) -> int:
    """The 4096-voxel tile's number of one axis of a root key, which keeps 20 bits of it."""
    number = bits & 0xFFFFF
    return number - (1 << 20) if number & (1 << 19) else number


def _paint(
    blocks: F32, corner: NDArray[np.int64], low: NDArray[np.int64], table: F32, side: int
) -> None:
    """Put a node's values, `side` blocks across each, where it overlaps the blocks."""
    # Per axis: which blocks it covers, and in which of its values each of them lies.
    offsets = [int(n) for n in corner - low]
    # The overlap of the node with the blocks, along each axis.
    covered = [
        np.arange(max(0, -offset), min(count, side * values - offset))
        for offset, count, values in zip(offsets, blocks.shape, table.shape, strict=True)
    ]
    if all(len(numbers) for numbers in covered):
        inside = (
            (numbers + offset) // side for numbers, offset in zip(covered, offsets, strict=True)
        )
        blocks[np.ix_(*covered)] = table[np.ix_(*inside)]


def _with_leaves(blocks: F32, corner: NDArray[np.int64], leaves: NDArray[np.void]) -> F32:
    """Voxels (x, y, z) of all blocks, those of the leaves in full."""
    x, y, z = blocks.shape
    shape = (x, 8, y, 8, z, 8)
    # Each block's value fills its 8^3 voxels, until a leaf has better ones.
    voxels = np.broadcast_to(blocks[:, None, :, None, :, None], shape).copy()
    at = (leaves["low"] >> 3) - corner
    here = ((at >= 0) & (at < blocks.shape)).all(axis=1)
    i, j, k = at[here].T
    voxels[i, :, j, :, k, :] = leaves["values"][here]
    return voxels.reshape(8 * x, 8 * y, 8 * z)
