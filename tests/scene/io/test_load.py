"""`load`: from a name to a scene."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from airlight.errors import SceneError
from airlight.scene.builtin import BUILTIN
from airlight.scene.camera import Camera
from airlight.scene.io import load, load_meshes


def test_a_bare_mesh_gets_light_and_a_camera(tmp_path):
    for name in ("a.obj", "a.ply", "a.stl", "a.glb", "A.PLY"):
        path = tmp_path / name
        trimesh.creation.icosphere().export(path, file_type=path.suffix.lower()[1:])
        scene = load(str(path))
        assert scene.triangle_count == 1280, name
        assert len(scene.lights) == 1
        assert scene.environment is not None
        assert scene.camera != Camera()
        bare = load_meshes(path)
        assert bare.lights == ()
        assert bare.camera == Camera()


def test_a_files_own_camera_and_light_stay(draft):
    draft.single(draft.triangle())
    draft.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0}}]
    draft.json["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
    light = {"KHR_lights_punctual": {"light": 0}}
    draft.json["nodes"].append({"camera": 0, "translation": [0, 0, 3], "extensions": light})
    draft.json["scenes"][0]["nodes"].append(1)
    scene = load(draft.glb())
    assert scene.camera.position == (0, 0, 3)
    assert len(scene.lights) == 1
    assert scene.environment is None


def test_a_toml_scene(tmp_path):
    (tmp_path / "a.toml").write_text('[[mesh]]\nshape = "box"\n')
    assert load(tmp_path / "a.toml").triangle_count == 12


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.md", "a scene file cannot end in '.md'. Known: .glb, .gltf, .nc, .nc4, .npy, "),
        ("a.fbx", "a scene file cannot end in '.fbx'. Export it as glTF (.glb) from the program"),
        (
            "a.blend",
            "a scene file cannot end in '.blend'. Export it as glTF (.glb) from the program",
        ),
        ("a.tmol", "Did you mean '.toml'?"),
        ("a", "file not found. For a scene that ships with airlight, write builtin:NAME."),
        ("a.obj", "a.obj: file not found. Check the path."),
        ("a.glb", "a.glb: file not found. Check the path."),
        ("a.stl", "a.stl: file not found. Check the path."),
    ],
)
def test_unknown_and_missing_files(tmp_path, name, message):
    with pytest.raises(SceneError) as error:
        load(tmp_path / name)
    assert message in str(error.value)


def test_living_room_loads_as_the_acceptance_scene(shared_data):
    scene = load(shared_data / "living_room" / "living_room.obj")
    assert scene.triangle_count == 28656
    assert len(scene.lights) == 1
    assert np.isfinite(scene.environment.map).all()
    assert {m.material.alpha for m in scene.meshes if m.material.is_translucent} == {0.5}
    assert any("a default sun and sky were added" in w for w in scene.warnings)


def test_a_builtin_scene_that_does_not_fit_is_one_message(monkeypatch):
    def too_large():
        raise MemoryError("Unable to allocate 3.00 GiB for an array with shape (1,)")

    monkeypatch.setitem(BUILTIN, "cornell", too_large)
    with pytest.raises(SceneError) as caught:
        load("builtin:cornell")
    assert str(caught.value) == (
        "builtin:cornell: the scene does not fit into memory (3.00 GiB were wanted at once). "
        "Free some memory."
    )


def test_a_bare_model_of_another_unit_that_stands_on_z(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1000 0 0\nv 0 500 2000\nf 1 2 3\n")
    scene = load(tmp_path / "a.obj", up="z", scale=0.001)
    np.testing.assert_allclose(scene.bounds, [(0, 0, -0.5), (1, 2, 0)], atol=1e-6)
    assert scene.name == "a"
    assert scene.camera != Camera()
    # The camera is chosen for the model as it stands, so that it is as a scene file's would be.
    text = '[[mesh]]\nfile = "a.obj"\nup = "z"\nscale = 0.001\n'
    (tmp_path / "a.toml").write_text(text)
    np.testing.assert_allclose(scene.bounds, load(tmp_path / "a.toml").bounds)


@pytest.mark.parametrize("name", ["builtin:cornell", "a.toml", "a.xml"])
def test_only_mesh_files_and_grids_are_turned_and_scaled(name):
    with pytest.raises(SceneError, match="up and scale are for mesh files and density grids"):
        load(name, up="z", scale=2.0)


def test_a_model_of_no_size_is_refused():
    with pytest.raises(SceneError, match="scale"):
        load("a.obj", scale=0.0)
