"""Primitives: modes, indices, attributes, missing normals."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.gltf import load_gltf

ZIGZAG = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (2, 0, 0)]


def test_strips_and_fans_keep_one_side(draft):
    strip = {"attributes": {"POSITION": draft.array(ZIGZAG, "f4")}, "mode": 5}
    (mesh,) = load_gltf(draft.single(strip).glb()).meshes
    a, b, c = mesh.geometry.positions[mesh.geometry.indices].transpose(1, 0, 2)
    np.testing.assert_allclose(np.cross(b - a, c - a)[:, 2], [-1, -1, -1])
    around = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (-1, 1, 0)]
    fan = {"attributes": {"POSITION": draft.array(around, "f4")}, "mode": 6}
    (mesh,) = load_gltf(draft.single(fan).glb()).meshes
    a, b, c = mesh.geometry.positions[mesh.geometry.indices].transpose(1, 0, 2)
    np.testing.assert_allclose(np.cross(b - a, c - a)[:, 2], [1, 1, 1])


def test_strips_joined_by_repeated_vertices(draft):
    strip = {
        "attributes": {"POSITION": draft.array(ZIGZAG, "f4")},
        "indices": draft.array([0, 1, 2, 2, 2, 3, 4], "u1"),
        "mode": 5,
    }
    assert load_gltf(draft.single(strip).glb()).triangle_count == 2


def test_missing_normals_are_flat(draft):
    points = [(0, 0, 0), (1, 0, 0), (0, 0, -1), (0, 0.2, 1)]
    primitive = {
        "attributes": {
            "POSITION": draft.array(points, "f4"),
            "TEXCOORD_0": draft.array([(0, 0), (1, 0), (0, 1), (1, 1)], "f4"),
        },
        "indices": draft.array([0, 1, 2, 0, 3, 1], "u4"),
    }
    (mesh,) = load_gltf(draft.single(primitive).glb()).meshes
    geometry = mesh.geometry
    assert len(geometry.positions) == len(geometry.uvs) == 6
    a, b, c = geometry.positions[geometry.indices].transpose(1, 0, 2)
    faces = np.cross(b - a, c - a)
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    for corner in range(3):
        np.testing.assert_allclose(geometry.normals[geometry.indices[:, corner]], faces, atol=1e-6)


def test_attributes_of_every_number_type(draft):
    primitive = draft.triangle(
        NORMAL=draft.array([(0, 0, 127)] * 3, "i1", normalized=True),
        TEXCOORD_0=draft.array([(0, 65535)] * 3, "u2", normalized=True),
        COLOR_0=draft.array([(255, 0, 51)] * 3, "u1", normalized=True),
    )
    (mesh,) = load_gltf(draft.single(primitive).glb()).meshes
    np.testing.assert_allclose(mesh.geometry.normals, [(0, 0, 1)] * 3)
    np.testing.assert_allclose(mesh.geometry.uvs, [(0, 1)] * 3)
    np.testing.assert_allclose(mesh.geometry.colors, [(1, 0, 0.2, 1)] * 3, atol=1e-6)


def test_quantised_positions(draft):
    positions = draft.array([(0, 0, 0), (100, 0, 0), (0, 100, 0)], "i2")
    draft.single({"attributes": {"POSITION": positions}}, scale=[0.01, 0.01, 0.01])
    draft.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    low, high = load_gltf(draft.glb()).bounds
    np.testing.assert_allclose(high - low, [1, 1, 0], atol=1e-6)


@pytest.mark.parametrize(
    ("indices", "dtype", "message"),
    [
        ([0, 1, 3], "u2", ".indices: index 3 is out of range: the primitive has 3 vertices"),
        ([0, 1], "u2", ": has no triangles"),
        ([0, 1, 2], "f4", ".indices: indices must be whole numbers"),
    ],
)
def test_bad_indices(draft, indices, dtype, message):
    primitive = draft.triangle()
    primitive["indices"] = draft.array(indices, dtype)
    with pytest.raises(SceneError) as error:
        load_gltf(draft.single(primitive).glb())
    assert str(error.value).endswith(f"thing.glb: meshes[0].primitives[0]{message}")


def test_nan_positions_and_uneven_attributes(draft):
    bad = draft.array([(0, 0, 0), (np.nan, 0, 0), (0, 1, 0)], "f4")
    with pytest.raises(SceneError, match=r"attributes\.POSITION: positions hold NaN"):
        load_gltf(draft.single({"attributes": {"POSITION": bad}}).glb())
    short = draft.triangle(NORMAL=draft.array([(0, 0, 1)] * 2, "f4"))
    with pytest.raises(SceneError, match="has 2 normals for 3 positions"):
        load_gltf(draft.single(short).glb())


def test_unknown_mode(draft):
    with pytest.raises(SceneError, match=r"primitives\[0\]: has the unknown mode 7"):
        load_gltf(draft.single({**draft.triangle(), "mode": 7}).glb())
