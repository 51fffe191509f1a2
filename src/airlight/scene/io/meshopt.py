"""Decoder of meshopt streams: attributes, triangles, indices, and the filters over attributes.

Source: Khronos, EXT_meshopt_compression, appendices A (bitstream) and B (filters). There is no
wheel of the reference library, so it is written out here; every loop runs over groups of 16
bytes or over triangles.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...maths.arrays import F32, U8

GROUP = 16
MOST_BLOCK_BYTES, MOST_BLOCK_ELEMENTS = 8192, 256
ATTRIBUTES, TRIANGLES, INDICES = 0xA0, 0xE0, 0xD0
_SMALLEST_TAIL = 32
_CODE_TABLE = 16

# Bytes to the small numbers packed in them, the first in the highest bits.
_QUARTERS = [bytes((b >> s) & 3 for s in (6, 4, 2, 0)) for b in range(256)]
_HALVES = [bytes((b >> 4, b & 15)) for b in range(256)]


class MeshoptError(ValueError):
    """A stream is damaged; the message says how."""


def decode_attributes(data: bytes, count: int, stride: int) -> U8:
    """(count, stride) bytes of mode ATTRIBUTES. Raises MeshoptError."""
    # Elements are whole words of four bytes.
    if stride % 4 or not 4 <= stride <= MOST_BLOCK_ELEMENTS:
        raise MeshoptError(f"its byteStride {stride} is no multiple of 4 up to 256")
    # The stream ends with the element before the first, from which differences start.
    tail = max(stride, _SMALLEST_TAIL)
    if len(data) < 1 + tail or data[0] != ATTRIBUTES:
        raise MeshoptError(_unknown(data, "ATTRIBUTES"))
    last = np.frombuffer(data, np.uint8, stride, len(data) - stride)
    block = min(MOST_BLOCK_BYTES // stride & ~(GROUP - 1), MOST_BLOCK_ELEMENTS)
    # Block after block, and of each block one byte column after the other.
    stream = _Stream(data, 1, len(data) - tail)
    out = np.empty((count, stride), np.uint8)
    for first in range(0, count, block):
        rows = min(block, count - first)
        deltas = np.empty((stride, rows), np.uint8)
        for k in range(stride):
            deltas[k] = np.frombuffer(_byte_column(stream, rows), np.uint8, rows)
        # Zigzag, then running sums modulo 256 from the element before.
        steps = (deltas >> 1) ^ (0 - (deltas & 1)).astype(np.uint8)
        out[first : first + rows] = np.cumsum(steps.T, axis=0, dtype=np.uint8) + last
        last = out[first + rows - 1]
    return out


class _Stream:
    """Bytes read from the front, never beyond `end`."""

    def __init__(self, data: bytes, at: int, end: int) -> None:
        self.data, self.at, self.end = data, at, end

    def take(self, count: int) -> bytes:
        if self.at + count > self.end:
            raise MeshoptError("its stream ends too early")
        taken = self.data[self.at : self.at + count]
        self.at += count
        return taken

    def number(self) -> int:
        """A number of seven bits a byte, the lowest first."""
        value = 0
        for shift in range(0, 35, 7):
            (byte,) = self.take(1)
            value |= (byte & 127) << shift
            if byte < 128:
                return value
        raise MeshoptError("one of its numbers has more than five bytes")

    def step(self) -> int:
        """A signed difference, zigzag encoded."""
        value = self.number()
        return (value >> 1) ^ -(value & 1)


def _byte_column(stream: _Stream, rows: int) -> bytes:
    """One byte of each of a block's elements: groups of 16, at 0, 2, 4 or 8 bits a value."""
    groups = -(-rows // GROUP)
    header = stream.take(-(-groups // 4))
    parts = []
    # Two bits a group say how many bits its values have; the largest value stands for a byte of
    # its own.
    for g in range(groups):
        kind = (header[g // 4] >> (g % 4 * 2)) & 3
        if kind == 0:
            parts.append(bytes(GROUP))
        elif kind == 3:
            parts.append(stream.take(GROUP))
        else:
            # The largest value of a group's bits says that the whole byte follows behind the group.
            table, sentinel = (_QUARTERS, 3) if kind == 1 else (_HALVES, 15)
            values = b"".join([table[b] for b in stream.take(4 * kind)])
            escaped = values.count(sentinel)
            parts.append(_escaped(values, sentinel, stream.take(escaped)) if escaped else values)
    return b"".join(parts)


def _escaped(values: bytes, sentinel: int, whole: bytes) -> bytes:
    """The same with each sentinel replaced by the next of `whole`."""
    following = iter(whole)
    return bytes(next(following) if v == sentinel else v for v in values)


def decode_triangles(data: bytes, count: int) -> NDArray[np.uint32]:
    """(count,) indices of mode TRIANGLES. Raises MeshoptError."""
    if count % 3 or len(data) < 1 + count // 3 + _CODE_TABLE or data[0] & ~1 != TRIANGLES:
        raise MeshoptError(_unknown(data, "TRIANGLES"))
    return np.array(_Triangles(data, count // 3).decoded(), dtype=np.int64).astype(np.uint32)


class _Triangles:
    """Triangles named by the last 16 edges and vertices (appendix A.2)."""

    def __init__(self, data: bytes, count: int) -> None:
        self.codes = data[1 : 1 + count]
        self.table = data[-_CODE_TABLE:]
        self.stream = _Stream(data, 1 + count, len(data) - _CODE_TABLE)
        self.farthest = 13 if data[0] & 1 else 15
        self.edges = [(0, 0)] * 16
        self.vertices = [0] * 16
        self.edge_at = self.vertex_at = 0
        self.next = self.last = 0

    def decoded(self) -> list[int]:
        out: list[int] = []
        for code in self.codes:
            out += self._on_an_edge(code) if code < 0xF0 else self._apart(code)
        return out

    def _on_an_edge(self, code: int) -> tuple[int, int, int]:
        """A triangle that shares an edge with one of the last."""
        # The edge's number counts back from the last one.
        a, b = self.edges[(self.edge_at - 1 - (code >> 4)) & 15]
        # The third corner: a new one, one of the last, or one that is written out.
        kind = code & 15
        if kind < self.farthest:
            c = self._new() if kind == 0 else self.vertices[(self.vertex_at - 1 - kind) & 15]
            is_pushed = kind == 0
        else:
            c = self.last = self._explicit() if kind == 15 else self.last + (kind - (kind ^ 3))
            # As the encoder did: remember a corner that was not among the last, and both new edges.
            is_pushed = True
        if is_pushed:
            self._push_vertex(c)
        self._push_edge(c, b)
        self._push_edge(a, c)
        return a, b, c

    def _apart(self, code: int) -> tuple[int, int, int]:
        """A triangle of its own: each corner new, one of the last vertices, or written out."""
        # Common combinations stand in a table, others in a byte of the stream.
        if code < 0xFE:
            both, first = self.table[code & 15], 0
        else:
            (both,) = self.stream.take(1)
            first = 0 if code == 0xFE else 15
            # A byte of zeros restarts the numbers of new vertices.
            if both == 0:
                self.next = 0
        # A vertex is looked up before those of this triangle are pushed.
        kinds = (first, both >> 4, both & 15)
        corners = [self._new() if k == 0 else self._recent(k) for k in kinds]
        # Corners that are written out follow each other in the stream, after the code.
        if code >= 0xFE:
            for i, kind in enumerate(kinds):
                if kind == 15:
                    corners[i] = self.last = self._explicit()
        # Corners that were not among the last vertices are remembered.
        for corner, kind in zip(corners, kinds, strict=True):
            if kind == 0 or (kind == 15 and code >= 0xFE):
                self._push_vertex(corner)
        a, b, c = corners
        # Edges are kept against their sense, as a neighbour runs along them.
        self._push_edge(b, a)
        self._push_edge(c, b)
        self._push_edge(a, c)
        return a, b, c

    def _new(self) -> int:
        self.next += 1
        return self.next - 1

    def _recent(self, kind: int) -> int:
        return self.vertices[(self.vertex_at - kind) & 15]

    def _explicit(self) -> int:
        return self.last + self.stream.step()

    def _push_vertex(self, v: int) -> None:
        self.vertices[self.vertex_at] = v
        self.vertex_at = (self.vertex_at + 1) & 15

    def _push_edge(self, a: int, b: int) -> None:
        self.edges[self.edge_at] = (a, b)
        self.edge_at = (self.edge_at + 1) & 15


def decode_indices(data: bytes, count: int) -> NDArray[np.uint32]:
    """(count,) indices of mode INDICES: differences to one of two runs. Raises MeshoptError."""
    if len(data) < 5 or data[0] & ~1 != INDICES:
        raise MeshoptError(_unknown(data, "INDICES"))
    stream = _Stream(data, 1, len(data) - 4)
    # Zigzag differences to the last index of either run, which the lowest bit chooses.
    last = [0, 0]
    out = np.empty(count, np.int64)
    for k in range(count):
        value = stream.number()
        run, value = value & 1, value >> 1
        last[run] += (value >> 1) ^ -(value & 1)
        out[k] = last[run]
    return out.astype(np.uint32)


def unfiltered(rows: U8, name: str) -> U8:
    """(count, stride) bytes as they were before the filter `name`. Raises MeshoptError."""
    stride = rows.shape[1]
    if name == "NONE":
        return rows
    # The filters of EXT_meshopt_compression: unit vectors, quaternions, and floats as mantissa and
    # exponent.
    if name == "OCTAHEDRAL" and stride in (4, 8):
        return _octahedral(rows.view(np.int8 if stride == 4 else "<i2")).view(np.uint8)
    if name == "QUATERNION" and stride == 8:
        return _quaternion(rows.view("<i2")).view(np.uint8)
    if name == "EXPONENTIAL":
        words = rows.view("<i4")
        mantissa, exponent = (words << 8) >> 8, words >> 24
        floats: F32 = np.ldexp(mantissa.astype(np.float32), exponent)
        return floats.astype("<f4").view(np.uint8)
    raise MeshoptError(f"the filter {name} is not one for elements of {stride} bytes")


def _octahedral(v: NDArray[np.signedinteger]) -> NDArray[np.signedinteger]:
    """Unit vectors from the octahedron; the fourth component stays."""
    # Signed octahedral coordinates, with the value of 1 beside them; z is the rest.
    top = np.iinfo(v.dtype).max
    x, y, one = (v[:, k].astype(np.float32) for k in range(3))
    z = one - np.abs(x) - np.abs(y)
    # Where z is negative the lower half had been folded over the upper.
    fold = np.minimum(z, 0.0)
    x, y = x + np.where(x >= 0.0, fold, -fold), y + np.where(y >= 0.0, fold, -fold)
    # Lengths of 1 again, in integers of the same width.
    length = np.maximum(np.sqrt(x * x + y * y + z * z), 1e-30)
    out = v.copy()
    for k, part in enumerate((x, y, z)):
        out[:, k] = _rounded(part * (top / length))
    return out


def _quaternion(v: NDArray[np.int16]) -> NDArray[np.int16]:
    """Unit quaternions from their three smallest components and where the largest stands."""
    # The fourth component holds the scale, and in its lowest two bits which one is the largest.
    scale = np.float32(2.0**-0.5) / (v[:, 3] | 3).astype(np.float32)
    three = v[:, :3].astype(np.float32) * scale[:, None]
    # Of length 1, so that the largest follows from the other three.
    largest = np.sqrt(np.maximum(1.0 - (three * three).sum(1), 0.0))
    at, rows = (v[:, 3] & 3).astype(np.int64), np.arange(len(v))
    out = np.empty_like(v)
    for k in range(3):
        out[rows, (at + 1 + k) & 3] = _rounded(three[:, k] * 32767.0)
    out[rows, at] = _rounded(largest * 32767.0)
    return out


def _rounded(x: NDArray[np.floating]) -> NDArray[np.floating]:
    """To the nearest, halves away from zero."""
    return np.asarray(np.trunc(x + np.where(x >= 0.0, 0.5, -0.5)))


def _unknown(data: bytes, mode: str) -> str:
    head = f"{data[0]:#04x}" if data else "nothing"
    return f"it begins with {head}: no stream of mode {mode} that airlight reads"
