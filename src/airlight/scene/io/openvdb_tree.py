"""The voxels of an OpenVDB tree of floats or of vectors of three.

A tree is a root, two levels of inner nodes, and leaves of 8^3.

Each inner node and the root hold children, and tiles: one value for a whole child's extent.
Topology comes first, depth first; the leaves' values follow in the same order.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import F32, F64
from .nanovdb import check_span

_TYPES = {"float": ("<f4", 1), "double": ("<f8", 1), "vec3s": ("<f4", 3), "vec3d": ("<f8", 3)}
"""How a value of a tree is stored, and how many numbers it is."""
_TREE = "_5_4_3"
_AS_HALF = "_HalfFloat"
_ZIP, _ACTIVE_MASK, _BLOSC = 1, 2, 4
_LEAF_LOG2 = 3
_LEVELS = (5, 4)  # log2 of children a side, from the root's children down
_LEAF_VALUES = 512
# What a node says of its inactive values.
_ALL_BACKGROUND, _ALL_MINUS_BACKGROUND, _ALL_ONE_VALUE = 0, 1, 2
_MASK_OF_BACKGROUNDS, _MASK_AND_ONE_VALUE, _MASK_AND_TWO_VALUES, _EVERY_VALUE = 3, 4, 5, 6

Corner = tuple[int, int, int]


class VdbError(ValueError):
    """The file is damaged; the message says how."""


class VdbStream:
    """A file's bytes, read from `at`; never beyond their end."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def take(self, count: int) -> bytes:
        """The next `count` bytes."""
        if count < 0 or self.at + count > len(self.data):
            raise VdbError(f"it ends after {len(self.data):,} bytes")
        taken = self.data[self.at : self.at + count]
        self.at += count
        return taken

    def unpack(self, layout: str) -> tuple[Any, ...]:
        """The next values of a struct's layout."""
        return struct.unpack(layout, self.take(struct.calcsize(layout)))

    def sized(self) -> bytes:
        """Bytes behind their number."""
        (count,) = self.unpack("<I")
        return self.take(count)

    def text(self) -> str:
        """UTF-8 behind its length."""
        return self.sized().decode()

    def mask(self, count: int) -> NDArray[np.bool_]:
        """(count,) bits."""
        packed = np.frombuffer(self.take(count // 8), np.uint8)
        return np.unpackbits(packed, bitorder="little").astype(bool)


@dataclass
class _Found:
    """What has a value: leaves by corner and mask, tiles by corner, side, value and state."""

    leaves: list[tuple[Corner, NDArray[np.bool_]]] = field(default_factory=list)
    tiles: list[tuple[NDArray[np.int64], int, F32, NDArray[np.bool_]]] = field(default_factory=list)


@dataclass
class _Values:
    """How a tree's values are stored; of vectors each has `width` numbers."""

    stream: VdbStream
    dtype: str
    width: int
    is_half: bool
    compression: int

    def __post_init__(self) -> None:
        self.background = self.one()

    @property
    def shape(self) -> tuple[int, ...]:
        """Of one value."""
        return () if self.width == 1 else (self.width,)

    def read(self, mask: NDArray[np.bool_]) -> F32:
        """(n,) or (n, 3) values of a node, whose active ones the (n,) `mask` says."""
        # A sparse node stores its active values alone, and what the others are beside them.
        inactive, selected = self._inactive(len(mask))
        is_sparse = bool(self.compression & _ACTIVE_MASK) and inactive is not None
        stored = self._stored(int(mask.sum()) if is_sparse else len(mask))
        if not is_sparse or inactive is None:
            return stored
        where = selected.reshape(-1, *[1] * len(self.shape))
        values = np.where(where, inactive[1], inactive[0]).astype(np.float32)
        values[mask] = stored
        return values

    def _inactive(self, count: int) -> tuple[tuple[F64, F64] | None, NDArray[np.bool_]]:
        """The two inactive values and where the second is; None where all are stored."""
        (kind,) = self.stream.unpack("<b")
        first, second = -self.background, self.background
        none = np.zeros(count, dtype=bool)
        if kind == _EVERY_VALUE:
            return None, none
        # What inactive voxels hold is not stored where it is one of two values.
        if kind == _ALL_BACKGROUND:
            first = self.background
        elif kind in (_ALL_ONE_VALUE, _MASK_AND_ONE_VALUE, _MASK_AND_TWO_VALUES):
            first = self.one()
            if kind == _MASK_AND_TWO_VALUES:
                second = self.one()
        elif kind not in (_ALL_MINUS_BACKGROUND, _MASK_OF_BACKGROUNDS):
            raise VdbError(f"a node's inactive values are of the unknown kind {kind}")
        # The mask says which of the two values each inactive voxel has.
        has_mask = kind in (_MASK_OF_BACKGROUNDS, _MASK_AND_ONE_VALUE, _MASK_AND_TWO_VALUES)
        return (first, second), self.stream.mask(count) if has_mask else none

    def one(self) -> F64:
        """A value that stands alone: never packed, never half."""
        raw = self.stream.take(self.width * np.dtype(self.dtype).itemsize)
        return np.frombuffer(raw, self.dtype).astype(np.float64).reshape(self.shape)

    def _stored(self, count: int) -> F32:
        dtype = np.dtype("<f2" if self.is_half else self.dtype)
        raw = self._unpacked(count * self.width * dtype.itemsize)
        return np.frombuffer(raw, dtype).astype(np.float32).reshape(-1, *self.shape)

    def _unpacked(self, size: int) -> bytes:
        """`size` bytes, behind their packed length where they are packed."""
        if not self.compression & (_ZIP | _BLOSC):
            return self.stream.take(size)
        # Negative lengths mark what was stored as it is. Unpacking stops one byte late, which shows
        # a file that lies about its size.
        (packed,) = self.stream.unpack("<q")
        if packed <= 0:  # the negative length of what would not shrink
            raw = self.stream.take(-packed)
        elif self.compression & _BLOSC:
            raw = _from_blosc(self.stream.take(packed), size)
        else:
            try:
                raw = zlib.decompressobj().decompress(self.stream.take(packed), size + 1)
            except zlib.error as error:
                raise VdbError(f"a node's values cannot be decompressed: {error}") from None
        if len(raw) != size:
            raise VdbError(f"a node has {len(raw)} bytes of values, not {size}")
        return raw


def _from_blosc(packed: bytes, size: int) -> bytes:
    try:
        import blosc
    except ImportError:
        raise SceneError(
            "is packed by Blosc, which needs the package blosc",
            remedy="Run: pip install 'airlight[vdb]'.",
        ) from None
    # Its header names the unpacked size, which blosc allocates.
    if len(packed) < 16 or struct.unpack_from("<I", packed, 4)[0] != size:
        raise VdbError("a node's Blosc data have another size than its values")
    try:
        return bytes(blosc.decompress(packed))
    except Exception as error:  # blosc's own, without a family
        raise VdbError(f"a node's values cannot be decompressed: {error}") from None


def read_tree(stream: VdbStream, kind: str, compression: int, end: int) -> tuple[F32, Corner]:
    """The active box of a tree, dense: values (x, y, z), of vectors (x, y, z, 3), and its corner.

    A tree without active voxels is one voxel of nothing at the origin.

    `kind` is the grid's type as its descriptor names it. Raises VdbError for damage, SceneError
    for trees of other values and boxes that are too large.
    """
    name = kind.removesuffix(_AS_HALF).removeprefix("Tree_").removesuffix(_TREE)
    if name not in _TYPES:
        raise SceneError(f"holds a {kind}, only trees of float, double and vec3 are read")
    dtype, width = _TYPES[name]
    if stream.unpack("<I")[0] != 1:
        raise VdbError("its tree has several buffers")
    values = _Values(stream, dtype, width, kind.endswith(_AS_HALF), compression)

    # The topology: tiles with their values, leaves with masks alone.
    found = _Found()
    _read_root(values, found)

    # The leaves' values, in the order of the topology.
    box = _active_box(found)
    if box is None:
        return np.zeros((1, 1, 1, *values.shape), np.float32), (0, 0, 0)
    low, high = box
    check_span(high - low, len(stream.data))
    dense = np.empty((*(high - low), *values.shape), dtype=np.float32)
    dense[...] = values.background
    _put_tiles(dense, low, found)
    for corner, _ in found.leaves:
        mask = stream.mask(_LEAF_VALUES)
        block = values.read(mask).reshape(8, 8, 8, *values.shape)
        _put(dense, np.array(corner) - low, block)
    # A grid ends where its descriptor says; more means that masks or lengths are damaged.
    if stream.at > end:
        raise VdbError("its leaves go on beyond the grid's end")
    x, y, z = low.tolist()
    return dense, (x, y, z)


def _read_root(values: _Values, found: _Found) -> None:
    """Tiles and children of the root: each 4096 voxels a side."""
    stream = values.stream
    side = 1 << (_LEAF_LOG2 + sum(_LEVELS))
    tiles, children = stream.unpack("<II")
    for _ in range(tiles):
        corner = np.array([stream.unpack("<3i")], dtype=np.int64)
        value = values.one().astype(np.float32)[None]
        is_active = np.array([stream.unpack("<B")[0] != 0])
        found.tiles.append((corner, side, value, is_active))
    for _ in range(children):
        _read_inner(values, stream.unpack("<3i"), 0, found)


def _read_inner(values: _Values, corner: Corner, level: int, found: _Found) -> None:
    """An inner node: its tiles, then the nodes or leaves below it."""
    stream, log2 = values.stream, _LEVELS[level]
    side = 1 << (_LEAF_LOG2 + sum(_LEVELS[level + 1 :]))
    count = 1 << 3 * log2
    # Which cells have nodes below them, and which of the others are active.
    has_child, is_active = stream.mask(count), stream.mask(count)
    tiles = values.read(is_active)
    offsets = np.arange(count)
    # The x offset is in the highest bits of a cell's number, z in the lowest.
    cells = np.stack([offsets >> 2 * log2, offsets >> log2, offsets], axis=1) & ((1 << log2) - 1)
    corners = np.array(corner, dtype=np.int64) + side * cells
    # Inactive tiles of the background are what the box holds anyway.
    is_other = (tiles != values.background.astype(np.float32)).reshape(count, -1).any(axis=1)
    is_tile = ~has_child & (is_active | is_other)
    if is_tile.any():
        found.tiles.append((corners[is_tile], side, tiles[is_tile], is_active[is_tile]))
    # Nodes below follow each other, depth first.
    for below in corners[has_child].tolist():
        if level + 1 < len(_LEVELS):
            _read_inner(values, tuple(below), level + 1, found)
        else:
            found.leaves.append((tuple(below), stream.mask(_LEAF_VALUES)))


def _active_box(found: _Found) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """First voxel (3,) of what is active, and the one beyond the last; None where nothing is."""
    lows, highs = [], []
    # The leaves' active voxels, then the tiles'.
    for corner, mask in found.leaves:
        inside = np.nonzero(mask.reshape(8, 8, 8))
        if len(inside[0]):
            lows.append([c + int(k.min()) for c, k in zip(corner, inside, strict=True)])
            highs.append([c + int(k.max()) + 1 for c, k in zip(corner, inside, strict=True)])
    for corners, side, _, is_active in found.tiles:
        if is_active.any():
            lows.append(corners[is_active].min(axis=0).tolist())
            highs.append((corners[is_active].max(axis=0) + side).tolist())
    if not lows:
        return None
    return np.min(lows, axis=0).astype(np.int64), np.max(highs, axis=0).astype(np.int64)


def _put_tiles(dense: F32, low: NDArray[np.int64], found: _Found) -> None:
    """Fill tiles, and what lies between them inside of a level set, into the box."""
    for corners, side, tiles, _ in found.tiles:
        begin = np.clip(corners - low, 0, dense.shape[:3])
        end = np.clip(corners - low + side, 0, dense.shape[:3])
        for (x, y, z), (to_x, to_y, to_z), value in zip(
            begin.tolist(), end.tolist(), tiles.tolist(), strict=True
        ):
            dense[x:to_x, y:to_y, z:to_z] = value


def _put(dense: F32, at: NDArray[np.int64], block: F32) -> None:
    """Copy a leaf's block to `at`, as far as it lies in the box."""
    begin, end = np.maximum(at, 0), np.minimum(at + 8, dense.shape[:3])
    if (begin >= end).any():
        return
    inside = tuple(slice(b, e) for b, e in zip(begin, end, strict=True))
    part = tuple(slice(b - a, e - a) for a, b, e in zip(at, begin, end, strict=True))
    dense[inside] = block[part]
