"""What is written is read again as the same scene; what cannot be written is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene import Camera, DirectionalLight, Environment, Medium, PointLight, SpotLight
from airlight.scene.io import load
from airlight.scene.io.toml_text import scene_text

SCENE = """
# a comment
[camera]
position = [0, 1, 5]
target = [0, 1, 0]
exposure_stops = 1.5

[[mesh]]
shape = "box"
translate = [0, 0.5, 0]
base_color = [0.5, 0.25, 1.0]

[[mesh]]
file = "tri.obj"

[[light]]
type = "directional"
direction = [0, -1, 0]
irradiance = [3, 2, 1]

[environment]
radiance = 0.5

[medium]
sigma_s = 0.12
sigma_a = [0.01, 0.02, 0.0]

[[volume]]
shape = "sphere"
bounds = [[-1, -1, -1], [1, 1, 1]]
sigma_t = 10.0

[technique.lpv-scatter]
resolution = 16
"""
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture
def path(tmp_path):
    (tmp_path / "tri.obj").write_text(OBJ)
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


def again(scene, source, folder, settings=None):
    """The scene read from its own text, written into `folder`."""
    text = scene_text(scene, load(source), str(source), folder, settings)
    copy = folder / "copy.toml"
    copy.write_text(text, encoding="utf-8")
    return load(copy), text


def test_an_unchanged_scene_comes_back(path):
    scene = load(path)
    copy, _ = again(scene, path, path.parent)
    assert copy.camera == scene.camera
    assert copy.lights == scene.lights
    assert copy.settings == scene.settings
    assert copy.environment.radiance == scene.environment.radiance
    assert np.allclose(copy.medium.sigma_t, scene.medium.sigma_t, rtol=1e-6)
    assert np.allclose(copy.medium.sigma_a, scene.medium.sigma_a, atol=1e-7)
    assert copy.volumes[0].sigma_t == scene.volumes[0].sigma_t
    assert len(copy.meshes) == 2
    assert copy.meshes[0].material.base_color == scene.meshes[0].material.base_color


def test_changes_come_back_changed(path):
    scene = load(path)
    lights = (
        DirectionalLight((0.6, -0.8, 0.0), (1.0, 1.0, 1.0)),
        PointLight((1.0, 2.0, 3.0), (4.0, 5.0, 6.0)),
        SpotLight((1.0, 2.0, 3.0), (0.0, -1.0, 0.0), (7.0, 7.0, 7.0), 10.0, 25.0),
    )
    changed = replace(
        scene,
        camera=Camera((1.0, 2.0, 3.0), (0.0, 0.1, 0.0), (0.0, 0.0, 1.0), 35.0, -2.0),
        lights=lights,
        environment=replace(scene.environment, scale=2.0, rotation_deg=30.0, visible=False),
        medium=Medium((0.3, 0.2, 0.1), (0.9, 0.9, 0.8), (0.5, 0.5, 0.5), ((-1, 0, -1), (1, 2, 1))),
        volumes=(replace(scene.volumes[0], sigma_t=(4.0, 5.0, 6.0), g=(0.8, 0.8, 0.8)),),
    )
    copy, text = again(changed, path, path.parent, {"lpv-scatter": {"iterations": 12}})
    assert copy.camera == changed.camera
    assert copy.lights == lights
    assert copy.medium == changed.medium
    assert copy.volumes[0].sigma_t == (4.0, 5.0, 6.0)
    assert copy.volumes[0].g == (0.8, 0.8, 0.8)
    assert copy.settings == {"lpv-scatter": {"resolution": 16, "iterations": 12}}
    e = copy.environment
    assert (e.scale, e.rotation_deg, e.visible) == (2.0, 30.0, False)
    assert "irradiance = 1.0" in text  # a grey is one number


def test_paths_follow_the_folder(path, tmp_path):
    other = tmp_path / "elsewhere" / "deep"
    other.mkdir(parents=True)
    copy, text = again(load(path), path, other)
    assert 'file = "../../tri.obj"' in text
    assert len(copy.meshes) == 2


def test_a_bare_mesh_file_becomes_a_scene_file(tmp_path):
    (tmp_path / "tri.obj").write_text(OBJ)
    scene = load(tmp_path / "tri.obj")
    sun = replace(scene.lights[0], direction=(0.0, -0.6, -0.8))
    moved = replace(scene, lights=(sun,), environment=Environment((0.25, 0.25, 0.25)))
    copy, _ = again(moved, tmp_path / "tri.obj", tmp_path)
    assert copy.lights[0].direction == pytest.approx(sun.direction)
    assert copy.environment.radiance == (0.25, 0.25, 0.25)
    assert copy.camera.position == pytest.approx(scene.camera.position, rel=1e-6)
    assert len(copy.meshes) == 1


def test_what_cannot_be_written_is_said(tmp_path):
    scene = load("builtin:cornell")
    pictured = replace(scene, environment=Environment(map=np.ones((2, 4, 3), np.float32)))
    text = scene_text(pictured, scene, "builtin:cornell", tmp_path)
    assert "# The meshes of builtin:cornell are no file" in text
    assert "# The environment's image is no file" in text
    assert "radiance = 1.0" in text


def test_unusual_names_and_texts_are_quoted(path):
    scene = replace(load(path), settings={"lpv": {"note": 'a "b"\n\\ ü', "box": (0.0, 1e-9)}})
    copy, _ = again(scene, path, path.parent)
    assert copy.settings["lpv"]["note"] == 'a "b"\n\\ ü'
    assert copy.settings["lpv"]["box"] == [0.0, 1e-9]
