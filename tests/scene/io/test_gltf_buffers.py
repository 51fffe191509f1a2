"""Accessors: layouts, number types, sparse values; every way to run out of bytes."""

from __future__ import annotations

import base64

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.gltf import load_gltf, read_gltf
from airlight.scene.io.gltf_json import Item


def read(draft, accessor: int, width: int) -> np.ndarray:
    file = read_gltf(draft.glb())
    item = Item({"it": accessor}, "test", draft.folder)
    return file.buffers.array(item, "it", width=width)


def test_interleaved_vertices(draft):
    rows = np.zeros(4, dtype=[("position", "<f4", 3), ("uv", "<f4", 2)])
    rows["position"], rows["uv"] = np.arange(12).reshape(4, 3), np.arange(8).reshape(4, 2)
    view = draft.view(rows.tobytes(), byteStride=20)
    for offset, kind in ((0, "VEC3"), (12, "VEC2")):
        draft.json["accessors"].append(
            {
                "bufferView": view,
                "byteOffset": offset,
                "componentType": 5126,
                "count": 4,
                "type": kind,
            }
        )
    np.testing.assert_array_equal(read(draft, 0, 3), rows["position"])
    np.testing.assert_array_equal(read(draft, 1, 2), rows["uv"])


@pytest.mark.parametrize(
    ("dtype", "raw", "expected"),
    [
        ("u1", [0, 255], [0, 1]),
        ("i1", [-128, 127], [-1, 1]),
        ("u2", [0, 65535], [0, 1]),
        ("i2", [-32768, 32767], [-1, 1]),
    ],
)
def test_normalised_integers(draft, dtype, raw, expected):
    k = draft.array(raw, dtype, normalized=True)
    np.testing.assert_allclose(read(draft, k, 1)[:, 0], expected)


def test_sparse_values_replace_some_of_the_rest_or_of_zeros(draft):
    sparse = {
        "count": 2,
        "indices": {"bufferView": draft.view(bytes([1, 3])), "componentType": 5121},
        "values": {"bufferView": draft.view(np.array([7, 9], "<f4").tobytes())},
    }
    full = draft.array([0.5] * 4, "f4", sparse=sparse)
    np.testing.assert_array_equal(read(draft, full, 1)[:, 0], [0.5, 7, 0.5, 9])
    del draft.json["accessors"][full]["bufferView"]
    np.testing.assert_array_equal(read(draft, full, 1)[:, 0], [0, 7, 0, 9])


def test_a_buffer_in_a_file_with_an_escaped_name(draft):
    draft.single(draft.triangle())
    (draft.folder / "my data.bin").write_bytes(draft.binary)
    draft.json["buffers"] = [{"byteLength": len(draft.binary), "uri": "my%20data.bin"}]
    assert load_gltf(draft.gltf()).triangle_count == 1
    (draft.folder / "my data.bin").unlink()
    with pytest.raises(SceneError, match=r"my data\.bin: file not found"):
        load_gltf(draft.gltf())


def bend(*keys, value):
    """Sets json[key][key]... = value."""

    def change(json):
        for key in keys[:-1]:
            json = json[key]
        json[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (bend("accessors", 0, "count", value=9), "accessors[0]: needs 108 bytes, but its buffer"),
        (bend("accessors", 0, "componentType", value=1), "accessors[0]: has the unknown component"),
        (bend("accessors", 0, "type", value="VEC9"), "accessors[0]: has the unknown type 'VEC9'"),
        (bend("accessors", 0, "type", value="VEC2"), "accessors[0] has 2 components, not 3"),
        (bend("accessors", 0, "bufferView", value=5), "bufferView: is 5, but the file has 2"),
        (bend("accessors", 0, "count", value=2**40), "accessors[0]: of 1099511627776 elements"),
        (bend("bufferViews", 0, "byteLength", value=999), "bufferViews[0]: ends at byte 999"),
        (bend("bufferViews", 0, "byteStride", value=4), "accessors[0]: needs"),
        (bend("bufferViews", 0, "buffer", value=3), "buffer: is 3, but the file has 1 buffers"),
        (bend("buffers", value=[{"byteLength": 99}]), "buffers[0]: has no 'uri'"),
        (
            bend("buffers", value=[{"byteLength": 99, "uri": "data:;base64,AAAA"}]),
            "buffers[0]: has 3 bytes of the 99 it declares",
        ),
        (
            bend("buffers", value=[{"byteLength": 9, "uri": "data:;base64,%%%"}]),
            "buffers[0]: its embedded data is not base64",
        ),
        (
            bend("buffers", value=[{"byteLength": 9, "uri": "https://example.org/a.bin"}]),
            "is not a file beside this one",
        ),
        (bend("meshes", 0, "primitives", 0, "attributes", "POSITION", value=8), "POSITION: is 8"),
        (bend("nodes", 0, "mesh", value=2), "nodes[0].mesh: is 2, but the file has 1 meshes"),
        (bend("nodes", 0, "children", value=[7]), "nodes[0].children[0]: is 7"),
        (bend("asset", "version", value="1.0"), "glTF version '1.0' is not supported"),
        (bend("nodes", 0, "scale", value=[1, 2]), "nodes[0].scale: must be 3 finite numbers"),
    ],
)
def test_bad_documents_name_the_place(bent_triangle, change, message):
    path = bent_triangle(change)
    with pytest.raises(SceneError) as error:
        load_gltf(path)
    assert "thing.gltf: " in str(error.value) or message in str(error.value)
    assert message in str(error.value)


def test_sparse_index_out_of_range(draft):
    sparse = {
        "count": 1,
        "indices": {"bufferView": draft.view(bytes([4])), "componentType": 5121},
        "values": {"bufferView": draft.view(bytes(4))},
    }
    k = draft.array([0.5] * 4, "f4", sparse=sparse)
    with pytest.raises(SceneError, match=r"accessors\[0\]\.sparse: index 4 is out of range"):
        read(draft, k, 1)


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"{", "its JSON is broken"),
        (b"\xff\xfe", "its JSON is broken"),
        (b"[1]", "has no 'asset'"),
        (b"{}", "has no 'asset'"),
        (b"[" * 100_000, "its JSON is broken"),
        (b'{"asset": 3}', "glTF version '' is not supported"),
    ],
)
def test_not_json(tmp_path, raw, message):
    (tmp_path / "a.gltf").write_bytes(raw)
    with pytest.raises(SceneError) as error:
        load_gltf(tmp_path / "a.gltf")
    assert message in str(error.value)
    assert "a.gltf" in str(error.value)


def test_a_glb_that_is_none(tmp_path):
    (tmp_path / "a.glb").write_bytes(base64.b64encode(b"something else"))
    with pytest.raises(SceneError, match="not a GLB file"):
        load_gltf(tmp_path / "a.glb")
