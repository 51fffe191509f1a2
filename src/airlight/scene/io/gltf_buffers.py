"""glTF containers, buffers and accessors: bytes to checked arrays.

Source: Khronos, glTF 2.0 specification, sections 3.6 (binary data) and 4 (GLB).
"""

from __future__ import annotations

import base64
import binascii
import json
import re
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from .files import named_file, read_bytes
from .gltf_compressed import DRACO, decoded_primitive, decoded_view, has_draco, meshopt_extension
from .gltf_json import Item

COMPONENTS: dict[int, type[np.generic]] = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_MAX_VALUES = 2**30
_MODEST_ZEROS_BYTES = 1 << 26
_ZEROS_PER_BYTE = 64
"""Bytes of zeros, without a bufferView, for each byte of values, where there are more of them."""
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")  # a drive is one letter
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def read_container(path: Path) -> tuple[Item, bytes | None]:
    """The JSON document and, of a GLB, its binary chunk. Raises SceneError."""
    raw = read_bytes(path)
    binary: bytes | None = None
    # GLB holds the document as its first chunk.
    if raw[:4] == b"glTF":
        raw, binary = _glb_chunks(raw, path)
    elif path.suffix.lower() == ".glb":
        raise SceneError("not a GLB file: it does not begin with 'glTF'", where=path)
    # A byte order mark is allowed at the beginning, as some exporters write one.
    try:
        value = json.loads(raw.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise SceneError(f"its JSON is broken ({error})", where=path) from None
    # A document of glTF 2.0.
    document = Item(value, "", path)
    if not isinstance(value, dict) or not document.has("asset"):
        raise SceneError("not a glTF file: it has no 'asset'", where=path)
    version = document.child("asset").text("version")
    if not version.startswith("2"):
        raise SceneError(
            f"glTF version '{version}' is not supported", where=path, remedy="Export glTF 2.0."
        )
    return document, binary


def _glb_chunks(raw: bytes, path: Path) -> tuple[bytes, bytes | None]:
    truncated = SceneError(
        "the GLB file is truncated", where=path, remedy="Copy or export it again."
    )
    # The head of the container.
    if len(raw) < 20:
        raise truncated
    version, length = struct.unpack_from("<II", raw, 4)
    if version != 2:
        raise SceneError(f"GLB version {version} is not supported", where=path)
    if length > len(raw):
        raise truncated
    # Its chunks, each after its length and kind; of each kind the first counts.
    chunks: dict[int, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<II", raw, at)
        if at + 8 + size > length:
            raise truncated
        chunks.setdefault(kind, raw[at + 8 : at + 8 + size])
        at += 8 + size
    # JSON has to be there, the binary chunk need not.
    if _JSON_CHUNK not in chunks:
        raise SceneError("the GLB file has no JSON chunk", where=path)
    return chunks[_JSON_CHUNK], chunks.get(_BINARY_CHUNK)


def uri_bytes(item: Item, folder: Path) -> bytes:
    """What the `uri` of a buffer or image names: embedded data or a file, seen from `folder`."""
    uri = item.text("uri")
    if uri.startswith("data:"):
        head, _, body = uri.partition(",")
        if not head.endswith(";base64"):
            return unquote(body).encode("latin-1", "replace")
        try:
            return base64.b64decode(body, validate=True)
        except (binascii.Error, ValueError):
            raise item.error("its embedded data is not base64") from None
    return read_bytes(uri_file(item, folder))


def uri_file(item: Item, folder: Path) -> Path:
    """The file that the `uri` names, seen from `folder`. Raises SceneError as `named_file` does."""
    uri = item.text("uri")
    if _SCHEME.match(uri):
        raise item.error(f"'{uri[:200]}' is not a file beside this one", "Download it first.")
    return named_file(unquote(uri), f"{item.file}: {item.place}", folder)


class Buffers:
    """The binary data of a document; each buffer and accessor is decoded once."""

    def __init__(self, document: Item, binary: bytes | None) -> None:
        self.folder = document.file.parent
        self._binary = binary
        self._buffers = document.items("buffers")
        self._views = document.items("bufferViews")
        self.accessors = document.items("accessors")
        self._bytes: dict[int, bytes] = {}
        self._decompressed: dict[int, bytes] = {}
        self._decoded: dict[int, NDArray[Any]] = {}
        self._zeros_bytes = 0

    def view(self, item: Item, key: str = "bufferView") -> tuple[memoryview, int]:
        """The bytes of the buffer view that item[key] names, and its stride (0: packed)."""
        k = item.index(key, self._views, "bufferViews")
        view, stride = self._views[k], self._views[k].integer("byteStride", 0)
        compressed = meshopt_extension(view)
        if compressed is None:
            return self._slice(view), stride
        if k not in self._decompressed:
            self._decompressed[k] = decoded_view(compressed, bytes(self._slice(compressed)))
        return memoryview(self._decompressed[k]), stride

    def _slice(self, view: Item) -> memoryview:
        """The part of a buffer that a view, or its compressed form, names."""
        data = self._buffer(view)
        start, length = view.integer("byteOffset", 0), view.integer("byteLength", low=1)
        if start + length > len(data):
            raise view.error(
                f"ends at byte {start + length}, but its buffer has {len(data)}",
                "The file is damaged or truncated.",
            )
        return memoryview(data)[start : start + length]

    def decompress(self, primitive: Item) -> bool:
        """Decode what Draco compressed of a primitive, in place of its accessors' own bytes.

        False where DracoPy is not installed and the file holds the same uncompressed.
        """
        # The specification lets a file hold the same uncompressed, for readers without the decoder.
        extension = primitive.at("extensions", DRACO)
        attributes = primitive.child("attributes")
        k = attributes.index("POSITION", self.accessors, "accessors")
        if not has_draco() and self.accessors[k].has("bufferView"):
            return False
        # Bytes beyond the declared length are the container's padding.
        triangles, found = decoded_primitive(extension, bytes(self.view(extension)[0]))
        # The decoded values take the accessors' place, so that all that follows reads them as ever.
        if primitive.has("indices"):
            k = primitive.index("indices", self.accessors, "accessors")
            self._decoded[k] = triangles.reshape(-1, 1)
        for name, values in found.items():
            if attributes.has(name):
                k = attributes.index(name, self.accessors, "accessors")
                self._decoded[k] = _normalized(self.accessors[k], values)
        return True

    def _buffer(self, view: Item) -> bytes:
        k = view.index("buffer", self._buffers, "buffers")
        if k not in self._bytes:
            buffer = self._buffers[k]
            length = buffer.integer("byteLength", low=1)
            # From a file, from within the document, or from the container.
            if buffer.has("uri"):
                data = uri_bytes(buffer, self.folder)
            elif k == 0 and self._binary is not None:
                data = self._binary
            else:
                raise buffer.error("has no 'uri', and the file has no binary chunk")
            # Longer data than it says are cut; shorter ones are damage.
            if len(data) < length:
                raise buffer.error(
                    f"has {len(data)} bytes of the {length} it declares",
                    "The file is damaged or truncated.",
                )
            self._bytes[k] = data[:length]
        return self._bytes[k]

    def array(self, item: Item, key: str, *, width: int) -> NDArray[Any]:
        """The accessor that item[key] names: (n, width), floats where normalised, else as stored.

        `width` is how many components it must have.
        """
        k = item.index(key, self.accessors, "accessors")
        if k not in self._decoded:
            self._decoded[k] = self._decode(self.accessors[k])
        values = self._decoded[k]
        if values.shape[1] != width:
            raise item.child(key).error(
                f"{self.accessors[k].place} has {values.shape[1]} components, not {width}"
            )
        return values

    # Counts and types, before any value is read.
    def _decode(self, accessor: Item) -> NDArray[Any]:
        # Counts come from the file, and memory is not taken before they are known to be sane.
        dtype = self._dtype(accessor)
        kind = accessor.text("type")
        if kind not in WIDTHS:
            raise accessor.error(f"has the unknown type '{kind}'")
        count, width = accessor.integer("count", low=1), WIDTHS[kind]
        if count * width > _MAX_VALUES:
            raise accessor.error(f"of {count} elements is too large")
        # Dense values, or zeros, then those that a sparse accessor replaces, then the coding
        # undone.
        if accessor.has("bufferView"):
            values = self._strided(accessor, accessor, dtype, count, width)
        else:
            values = self._zeros(accessor, count, width, dtype)
        if accessor.has("sparse"):
            values = self._with_sparse(accessor, values)
        return _normalized(accessor, values)

    def _zeros(
        self, accessor: Item, count: int, width: int, dtype: type[np.generic]
    ) -> NDArray[Any]:
        """An accessor of nothing but zeros, as far as the file's size bears such ones out."""
        self._zeros_bytes += count * width * np.dtype(dtype).itemsize
        file_bytes = sum(len(data) for data in self._bytes.values())
        if self._zeros_bytes > max(_MODEST_ZEROS_BYTES, _ZEROS_PER_BYTE * file_bytes):
            raise accessor.error(
                f"of {count} elements has no bufferView, and its zeros are too many beside "
                f"{file_bytes:,} bytes of values"
            )
        return np.zeros((count, width), dtype=dtype)

    def _dtype(self, item: Item) -> type[np.generic]:
        code = item.integer("componentType")
        if code not in COMPONENTS:
            raise item.error(f"has the unknown componentType {code}")
        return COMPONENTS[code]

    def _strided(
        self, accessor: Item, source: Item, dtype: type[np.generic], count: int, width: int
    ) -> NDArray[Any]:
        # A stride of 0 means tightly packed; the last element need not fill its stride.
        data, stride = self.view(source)
        start, size = source.integer("byteOffset", 0), np.dtype(dtype).itemsize * width
        step = stride or size
        if step < size or start + (count - 1) * step + size > len(data):
            raise accessor.error(
                f"needs {start + (count - 1) * step + size} bytes, but its bufferView has "
                f"{len(data)}",
                "The file is damaged or truncated.",
            )
        # A view with strides reads interleaved vertices without a loop.
        rows = np.ndarray((count, size), np.uint8, buffer=data, offset=start, strides=(step, 1))
        values: NDArray[Any] = np.ascontiguousarray(rows).view(np.dtype(dtype).newbyteorder("<"))
        return values.reshape(count, width)

    def _with_sparse(self, accessor: Item, values: NDArray[Any]) -> NDArray[Any]:
        sparse = accessor.child("sparse")
        # Elements by their numbers, and what replaces them.
        count = sparse.integer("count", low=1)
        where, what = sparse.child("indices"), sparse.child("values")
        rows = self._strided(sparse, where, self._dtype(where), count, 1)[:, 0].astype(np.int64)
        if rows.max() >= len(values):
            raise sparse.error(f"index {rows.max()} is out of range: it has {len(values)} elements")
        replaced = values.copy()
        replaced[rows] = self._strided(sparse, what, values.dtype.type, count, values.shape[1])
        return replaced


def _normalized(accessor: Item, values: NDArray[Any]) -> NDArray[Any]:
    """Whole numbers as -1 to 1 or 0 to 1, where the accessor says so."""
    if not accessor.flag("normalized") or np.issubdtype(values.dtype, np.floating):
        return values
    top = np.float32(np.iinfo(values.dtype).max)
    return np.asarray(np.maximum(values.astype(np.float32) / top, np.float32(-1.0)))
