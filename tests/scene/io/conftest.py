"""A small glTF writer: enough to make any file, good or broken, by hand."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GltfDraft:
    """A document under construction; `json` may be bent at will before it is written."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.binary = bytearray()
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "bufferViews": [],
            "accessors": [],
        }

    def view(self, raw: bytes, **more: Any) -> int:
        """Appends bytes; the index of their buffer view."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(raw), **more}
        self.binary += raw
        self.json["bufferViews"].append(view)
        return len(self.json["bufferViews"]) - 1

    def array(self, values: Any, dtype: str, **more: Any) -> int:
        """Appends an array; the index of its accessor."""
        a = np.asarray(values, dtype=f"<{dtype}")
        a = a.reshape(len(a), -1)
        accessor = {
            "bufferView": self.view(a.tobytes()),
            "componentType": CODES[dtype],
            "count": len(a),
            "type": KINDS[a.shape[1]],
            **more,
        }
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def triangle(self, **attributes: int) -> dict[str, Any]:
        """A primitive: the triangle (0,0,0), (1,0,0), (0,1,0)."""
        positions = self.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], "f4")
        return {"attributes": {"POSITION": positions, **attributes}}

    def single(self, primitive: dict[str, Any], **node: Any) -> GltfDraft:
        """One mesh of one primitive on one node."""
        self.json["meshes"] = [{"primitives": [primitive]}]
        self.json["nodes"] = [{"mesh": 0, **node}]
        self.json["scenes"] = [{"nodes": [0]}]
        return self

    def gltf(self) -> Path:
        """Written as JSON with the buffer embedded."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        buffer = {"byteLength": len(self.binary), "uri": uri}
        document = {"buffers": [buffer], **self.json}
        path = self.folder / "thing.gltf"
        path.write_text(json.dumps(document))
        return path

    def glb(self) -> Path:
        """Written as one binary file."""
        document = {"buffers": [{"byteLength": len(self.binary)}], **self.json}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.binary) + b"\0" * (-len(self.binary) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(data), 0x004E4942) + data
        path = self.folder / "thing.glb"
        path.write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)
        return path


@pytest.fixture
def draft(tmp_path: Path) -> GltfDraft:
    """An empty glTF document."""
    return GltfDraft(tmp_path)


@pytest.fixture
def bent_triangle(draft: GltfDraft) -> Callable[[Callable[[dict[str, Any]], None]], Path]:
    """A good one-triangle file whose JSON `bend` spoils before it is written."""

    def write(bend: Callable[[dict[str, Any]], None]) -> Path:
        primitive = draft.triangle()
        primitive["indices"] = draft.array([0, 1, 2], "u2")
        draft.single(primitive)
        bend(draft.json)
        return draft.gltf()

    return write
