"""glTF meshes in meshopt's buffer views and in Draco's streams."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io import gltf_compressed
from airlight.scene.io.gltf import load_gltf

STREAMS = json.loads((Path(__file__).parent / "meshopt_streams.json").read_text())
MESHOPT = "EXT_meshopt_compression"
DRACO = "KHR_draco_mesh_compression"
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 2, 0), (1, 2, 3)], np.float32)
FACES = np.array([(0, 1, 2), (2, 1, 3)])


def meshopt_view(draft, name: str, mode: str, stride: int, **more) -> int:
    """A buffer view whose bytes are only in a meshopt stream."""
    raw, count = base64.b64decode(STREAMS[name]["data"]), STREAMS[name]["count"]
    packed = draft.json["bufferViews"].pop(draft.view(raw))
    extension = packed | {"byteStride": stride, "count": count, "mode": mode, **more}
    view = {"buffer": 1, "byteLength": count * stride, "extensions": {MESHOPT: extension}}
    if mode == "ATTRIBUTES":
        view["byteStride"] = stride
    draft.json["bufferViews"].append(view)
    return len(draft.json["bufferViews"]) - 1


def meshopt_grid(draft) -> dict:
    points = meshopt_view(draft, "attributes", "ATTRIBUTES", 8)
    triangles = meshopt_view(draft, "triangles", "TRIANGLES", 4)
    count = STREAMS["triangles"]["count"]
    draft.json["accessors"] += [
        {"bufferView": points, "componentType": 5122, "count": 23 * 23, "type": "VEC3"},
        {"bufferView": triangles, "componentType": 5125, "count": count, "type": "SCALAR"},
    ]
    draft.json["extensionsUsed"] = draft.json["extensionsRequired"] = [
        MESHOPT,
        "KHR_mesh_quantization",
    ]
    return {"attributes": {"POSITION": 0}, "indices": 1}


def whole(draft) -> Path:
    """The file, with a placeholder for the bytes that are only compressed."""
    fallback = {"byteLength": 1 << 20, "extensions": {MESHOPT: {"fallback": True}}}
    first = {
        "byteLength": len(draft.binary),
        "uri": "data:application/octet-stream;base64,"
        + base64.b64encode(bytes(draft.binary)).decode(),
    }
    draft.json["buffers"] = [first, fallback]
    path = draft.folder / "scene.gltf"
    path.write_text(json.dumps(draft.json))
    return path


def test_meshopt_views_are_decoded(draft):
    draft.single(meshopt_grid(draft))
    scene = load_gltf(whole(draft))
    assert scene.warnings == ()
    assert scene.triangle_count == 2 * 22 * 22
    low, high = scene.meshes[0].world_bounds
    np.testing.assert_array_equal(low[[0, 2]], (-66, 0))
    np.testing.assert_array_equal(high[[0, 2]], (22 * 37, 22 * 41))


@pytest.mark.parametrize(
    "change, problem",
    [
        ({"mode": "WAVELETS"}, "mode 'WAVELETS' is unknown"),
        ({"filter": "COLOR"}, "filter COLOR"),
        ({"count": 10**9}, "too many for"),
        ({"byteLength": 40}, "stream ends too early"),
        ({"byteLength": 10**6}, "ends at byte"),
    ],
)
def test_damaged_meshopt_is_one_error_with_its_place(draft, change, problem):
    draft.single(meshopt_grid(draft))
    draft.json["bufferViews"][0]["extensions"][MESHOPT] |= change
    with pytest.raises(SceneError, match=problem) as caught:
        load_gltf(whole(draft))
    assert "bufferViews[0]" in str(caught.value)


def draco_primitive(draft, raw: bytes, *, has_fallback: bool = False) -> dict:
    plain = {"componentType": 5126, "count": 4, "type": "VEC3"}
    if has_fallback:
        draft.array(CORNERS, "f4")
    else:
        draft.json["accessors"].append(plain)
    faces = {"componentType": 5125, "count": 6, "type": "SCALAR"}
    draft.json["accessors"].append(faces)
    if has_fallback:
        draft.json["accessors"][-1]["bufferView"] = draft.view(FACES.astype("<u4").tobytes())
    packed = {"bufferView": draft.view(raw), "attributes": {"POSITION": 0}}
    draft.json["extensionsUsed"] = [DRACO]
    return {"attributes": {"POSITION": 0}, "indices": 1, "extensions": {DRACO: packed}}


def points_of(scene) -> np.ndarray:
    geometry = scene.meshes[0].geometry
    return np.sort(geometry.positions[geometry.indices].reshape(-1, 9), axis=0)


def encoded() -> bytes:
    import DracoPy

    return DracoPy.encode(CORNERS, FACES, quantization_bits=20, preserve_order=True)


@pytest.mark.needs("DracoPy")
@pytest.mark.parametrize("is_required", [False, True])
def test_draco_is_decoded(draft, is_required):
    draft.single(draco_primitive(draft, encoded()))
    if is_required:
        draft.json["extensionsRequired"] = [DRACO]
    scene = load_gltf(draft.gltf())
    assert scene.warnings == ()
    # 20 bits over 3 m.
    expected = np.sort(CORNERS[FACES].reshape(-1, 9), axis=0)
    np.testing.assert_allclose(points_of(scene), expected, atol=3.0 / 2**20)


@pytest.mark.needs("DracoPy")
def test_damaged_draco_is_one_error_with_its_place(draft):
    raw = encoded()
    draft.single(draco_primitive(draft, raw[: len(raw) // 2]))
    with pytest.raises(SceneError, match=r"primitives\[0\].*Draco data cannot be decoded"):
        load_gltf(draft.gltf())


@pytest.mark.needs("DracoPy")
def test_an_attribute_that_draco_lacks_is_named(draft):
    primitive = draco_primitive(draft, encoded())
    primitive["extensions"][DRACO]["attributes"] = {"POSITION": 0, "NORMAL": 7}
    draft.single(primitive)
    with pytest.raises(SceneError, match="have no attribute 7"):
        load_gltf(draft.gltf())


def test_without_the_package_a_message_says_what_to_type(draft, monkeypatch):
    monkeypatch.setattr(gltf_compressed, "find_spec", lambda name: None)
    draft.single(draco_primitive(draft, b"DRACO..."))
    with pytest.raises(SceneError, match=r"pip install 'airlight\[gltf\]'"):
        load_gltf(draft.gltf())


def test_without_the_package_the_fallback_is_shown_with_a_warning(draft, monkeypatch):
    monkeypatch.setattr(gltf_compressed, "find_spec", lambda name: None)
    draft.single(draco_primitive(draft, b"DRACO...", has_fallback=True))
    scene = load_gltf(draft.gltf())
    assert scene.triangle_count == 2
    (line,) = scene.warnings
    assert "what the file holds uncompressed is shown" in line
