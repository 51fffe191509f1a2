"""Whole glTF files: trimesh writes, we read; nodes, instances, lights, cameras, bad files."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh

from airlight.errors import SceneError
from airlight.scene.camera import Camera
from airlight.scene.io.gltf import load_gltf
from airlight.scene.lights import DirectionalLight, PointLight, SpotLight


def world_triangles(scene) -> np.ndarray:
    parts = []
    for mesh in scene.meshes:
        matrix = mesh.world_from_object
        points = mesh.geometry.positions @ matrix[:3, :3].T + matrix[:3, 3]
        parts.append(points[mesh.geometry.indices])
    return np.concatenate(parts)


@pytest.mark.parametrize("suffix", ["glb", "gltf"])
def test_trimesh_writes_and_we_read_the_same_triangles(tmp_path, suffix):
    scene = trimesh.Scene()
    turn = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
    scene.add_geometry(trimesh.creation.icosphere(subdivisions=2), node_name="ball")
    scene.add_geometry(trimesh.creation.box((1, 2, 3)), node_name="box", transform=turn)
    path = tmp_path / f"pair.{suffix}"
    exported = scene.export(file_type=suffix)
    if isinstance(exported, dict):
        for name, raw in exported.items():
            (tmp_path / name.replace("model", "pair")).write_bytes(raw)
    else:
        path.write_bytes(exported)
    ours = world_triangles(load_gltf(path))
    theirs = scene.to_geometry().triangles
    assert len(ours) == len(theirs)
    np.testing.assert_allclose(
        np.sort(ours.mean(axis=1), axis=0), np.sort(theirs.mean(axis=1), axis=0), atol=1e-5
    )


def test_nodes_multiply_down_the_tree_and_instances_share_geometry(draft):
    draft.json["meshes"] = [{"primitives": [draft.triangle()]}]
    half = math.sqrt(0.5)
    shift = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]  # by columns: 5 along z
    draft.json["nodes"] = [
        {"children": [1, 2], "rotation": [0, half, 0, half], "scale": [2, 2, 2]},
        {"mesh": 0, "translation": [1, 0, 0]},
        {"mesh": 0, "matrix": shift, "name": "moved"},
    ]
    draft.json["scenes"] = [{"nodes": [0]}]
    first, second = load_gltf(draft.glb()).meshes
    assert first.geometry is second.geometry
    assert second.name == "moved"
    # A quarter turn about +Y takes +X to -Z and +Z to +X.
    np.testing.assert_allclose(first.world_from_object[:3, 3], [0, 0, -2], atol=1e-7)
    np.testing.assert_allclose(second.world_from_object[:3, 3], [10, 0, 0], atol=1e-7)
    np.testing.assert_allclose(first.world_from_object[:3, 0], [0, 0, -2], atol=1e-7)


def test_a_mirrored_node_stays_mirrored(draft):
    """Which side is the front then is the renderer's to know (specification 3.7.4)."""
    draft.single(draft.triangle(), scale=[-1, 1, 1])
    (mesh,) = load_gltf(draft.glb()).meshes
    assert np.linalg.det(mesh.world_from_object[:3, :3]) < 0


def test_punctual_lights(draft):
    draft.single(draft.triangle())
    lights = [
        {"type": "directional", "color": [1, 0.5, 0], "intensity": 4},
        {"type": "point", "intensity": 7},
        {"type": "spot", "intensity": 2, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
    ]
    draft.json["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    down = [-math.sqrt(0.5), 0, 0, math.sqrt(0.5)]
    for k in range(3):
        extension = {"KHR_lights_punctual": {"light": k}}
        draft.json["nodes"].append(
            {"extensions": extension, "rotation": down, "translation": [k, 2, 3]}
        )
    draft.json["scenes"][0]["nodes"] = [0, 1, 2, 3]
    sun, bulb, spot = load_gltf(draft.glb()).lights
    assert isinstance(sun, DirectionalLight)
    assert sun.irradiance == (4, 2, 0)
    np.testing.assert_allclose(sun.direction, [0, -1, 0], atol=1e-7)
    assert isinstance(bulb, PointLight)
    assert (bulb.position, bulb.intensity) == ((1, 2, 3), (7, 7, 7))
    assert isinstance(spot, SpotLight)
    assert spot.inner_deg == pytest.approx(math.degrees(0.1))
    assert spot.outer_deg == pytest.approx(math.degrees(0.5))
    np.testing.assert_allclose(spot.direction, [0, -1, 0], atol=1e-7)


def test_the_first_perspective_camera_is_taken(draft):
    draft.single(draft.triangle())
    draft.json["cameras"] = [
        {"type": "orthographic", "orthographic": {}},
        {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}},
    ]
    draft.json["nodes"] += [{"camera": 0}, {"camera": 1, "translation": [0, 1, 4]}]
    draft.json["scenes"][0]["nodes"] = [0, 1, 2]
    scene = load_gltf(draft.glb())
    assert scene.camera.position == (0, 1, 4)
    assert scene.camera.target == (0, 1, 3)
    assert scene.camera.fov_y_deg == pytest.approx(math.degrees(1.0))
    said = "\n".join(scene.warnings)
    assert "2 cameras: the first perspective one" in said
    assert "cameras[0]: only perspective" in said


def test_no_camera_and_points_left_out(draft):
    points = {**draft.triangle(), "mode": 0}
    draft.single(draft.triangle())
    draft.json["meshes"][0]["primitives"].append(points)
    scene = load_gltf(draft.glb())
    assert scene.camera == Camera()
    assert len(scene.meshes) == 1
    assert "meshes[0].primitives[1]: points and lines are left out" in scene.warnings[0]


def test_cycles_and_shared_children_are_refused(draft):
    draft.single(draft.triangle(), children=[1])
    draft.json["nodes"].append({"children": [0]})
    with pytest.raises(SceneError, match=r"thing\.glb: nodes\[0\]: is reached twice"):
        load_gltf(draft.glb())


def test_an_unknown_required_extension(draft):
    draft.single(draft.triangle())
    draft.json["extensionsRequired"] = ["ACME_magic"]
    with pytest.raises(SceneError, match="it needs the extension ACME_magic"):
        load_gltf(draft.glb())


def test_nothing_to_show(draft):
    with pytest.raises(SceneError, match="it has no triangles"):
        load_gltf(draft.glb())


@pytest.mark.parametrize("kept", [0, 3, 11, 19, 50, 200, -1])
def test_every_truncation_of_a_glb_is_one_scene_error(draft, kept):
    path = draft.single(draft.triangle()).glb()
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(SceneError, match=r"thing\.glb: "):
        load_gltf(path)


def test_random_damage_never_escapes_as_another_error(draft):
    path = draft.single(draft.triangle()).glb()
    good = path.read_bytes()
    rng = np.random.default_rng(3)
    for _ in range(150):
        raw = bytearray(good)
        raw[int(rng.integers(len(raw)))] = int(rng.integers(256))
        path.write_bytes(raw)
        try:
            load_gltf(path)
        except SceneError as error:
            assert "thing.glb" in str(error)
