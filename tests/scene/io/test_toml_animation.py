"""Keyframes and sequences in scene files; each mistake in one exact message."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.camera import Camera
from airlight.scene.io import load
from airlight.scene.io.toml_animation import volume_files

MOVING = """
[animation]
start_s = 0.5
fps = 12
loop = true
[camera]
position = [0, 1, 5]
target = [0, 1, 0]
fov_y_deg = 40
between = "linear"
[[camera.key]]
time_s = 0
position = [0, 1, 5]
[[camera.key]]
time_s = 4
position = [4, 1, 5]
[[light]]
type = "directional"
direction = [0, -1, 0]
irradiance = 3
[[light]]
type = "point"
position = [0, 2, 0]
intensity = 1
[[light.key]]
time_s = 1
intensity = 1
[[light.key]]
time_s = 2
intensity = [3, 1, 1]
[[mesh]]
shape = "quad"
scale = 10
[[mesh]]
shape = "box"
translate = [0, 0.5, 0]
key = [{ time_s = 0, rotate_deg = [0, 0, 0] }, { time_s = 1, rotate_deg = [0, 90, 0] }]
[environment]
radiance = 0.1
[[environment.key]]
time_s = 0
rotation_deg = 0
[[environment.key]]
time_s = 3
rotation_deg = 30
"""


@pytest.fixture
def scene_of(tmp_path):
    """scene_of(text): the scene of a file that says so."""

    def scene(text):
        path = tmp_path / "moving.toml"
        path.write_text(text)
        return load(path)

    return scene


def test_what_stands_under_a_table_moves_it(scene_of):
    scene = scene_of(MOVING)
    assert scene.camera.position == (0, 1, 5)
    a = scene.animation
    assert (a.start_s, a.last_s, a.fps, a.is_loop) == (0.5, 4.0, 12.0, True)
    at = scene.at(1.5)
    assert at.camera == Camera((1.5, 1, 5), (0, 1, 0), fov_y_deg=40.0)
    assert at.lights[0] == scene.lights[0]
    assert at.lights[1].intensity == (2, 1, 1) and at.lights[1].position == (0, 2, 0)
    assert at.environment.rotation_deg == pytest.approx(15.0)
    np.testing.assert_allclose(at.meshes[0].world_from_object, np.diag([10, 10, 10, 1]))
    turned = at.meshes[1].world_from_object  # the last key holds: +X to -Z
    np.testing.assert_allclose(turned[:3, 0], [0, 0, -1], atol=1e-12)
    np.testing.assert_allclose(turned[:3, 3], [0, 0.5, 0])


def test_a_sequence_of_files_is_a_volume_that_changes(scene_of, tmp_path):
    (tmp_path / "plume").mkdir()
    for k in (9, 10, 8):
        np.save(tmp_path / "plume" / f"d{k}.npy", np.full((2, 3, 4), k, np.float32))
    text = '[[volume]]\nsequence = "plume"\nsequence_fps = 2\nsigma_t = 1\n'
    text += "bounds = [[0,0,0],[1,1,1]]\n"
    for pattern in ("plume", "plume/d*.npy"):
        scene = scene_of(text.replace('"plume"', f'"{pattern}"'))
        found = [float(scene.at(t).volumes[0].density.max()) for t in (0.0, 0.5, 0.75, 4.0)]
        assert found == [8.0, 9.0, 9.5, 10.0]
        assert scene.volumes[0].bounds == ((0, 0, 0), (1, 1, 1))


BOX = '[[mesh]]\nshape = "box"\n'
MISTAKES = [
    (
        "[camera]\nposition=[0,0,1]\ntarget=[0,0,0]\nkey = 3\n" + BOX,
        "[camera]: key must be written as [[camera.key]] tables",
    ),
    (
        "[camera]\nposition=[0,0,1]\ntarget=[0,0,0]\nkey = [{time_s = 0, fov_deg = 3}]\n" + BOX,
        "unknown key 'fov_deg' in [camera] key 1. Did you mean 'fov_y_deg'?",
    ),
    (BOX + "key = [{time_s = 0}]\n", "[[mesh]] 1 key 1 changes nothing: it sets time_s alone"),
    (
        BOX + "key = [{translate = [0, 0, 0]}]\n",
        "[[mesh]] 1 key 1 has no time_s. It is when (number, seconds).",
    ),
    (
        BOX + "key = [{time_s = 0, scale = 1}, {time_s = 1, translate = [0, 0, 1]}]\n",
        "[[mesh]] 1: key 2 and key 1 differ in whether they set scale. "
        "All keyframes of a table set the same keys.",
    ),
    (
        BOX + "key = [{time_s = 1, scale = 1}, {time_s = 0, scale = 2}]\n",
        "[[mesh]] 1: keyframe times must rise, but 0 s comes after 1 s",
    ),
    (
        BOX + "matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\nkey = [{time_s = 1, scale = 1}]\n",
        "[[mesh]] 1 has keyframes beside matrix. Use translate, rotate_deg and scale.",
    ),
    (BOX + "clip_speed = 2\n", "[[mesh]] 1: clip_speed is set, but its file is not animated"),
    (
        BOX + '[[light]]\ntype = "point"\nposition = [0,0,0]\nintensity = 1\n'
        "key = [{time_s = 0, irradiance = 1}]\n",
        "unknown key 'irradiance' in [[light]] 1 key 1. Known: intensity, position, time_s.",
    ),
    (
        BOX + "[animation]\nfps = 3\n",
        "there is an [animation], but nothing moves. Add [[camera.key]], [[light.key]], "
        "[[mesh.key]], [[environment.key]] or a volume sequence.",
    ),
    (BOX + "[animation]\nfps = 0\n", "[animation]: fps = 0 is outside [1e-06, 1e+06]"),
    (
        '[[volume]]\nsequence = "no/*.npy"\nsigma_t = 1\n',
        "[[volume]] 1: sequence 'no/*.npy' names no files. "
        "Paths are relative to the scene file; * stands for any number.",
    ),
    (
        '[[volume]]\nshape = "box"\nsequence_fps = 3\nsigma_t = 1\n',
        "[[volume]] 1: sequence_fps belongs to a sequence",
    ),
]


@pytest.mark.parametrize(("text", "expected"), MISTAKES, ids=[m for _, m in MISTAKES])
def test_a_mistake_gets_one_exact_message(scene_of, tmp_path, text, expected):
    with pytest.raises(SceneError) as caught:
        scene_of(text)
    assert str(caught.value) == f"{tmp_path / 'moving.toml'}: {expected}"


def test_files_are_sorted_by_their_numbers(tmp_path):
    for name in ("a_2.npy", "a_10.npy", "a_1.npy", ".a_0.npy"):
        (tmp_path / name).touch()
    found = volume_files("a_*.npy", tmp_path, "[[volume]] 1")
    assert [f.name for f in found] == ["a_1.npy", "a_2.npy", "a_10.npy"]
    with pytest.raises(SceneError, match="must name files of one folder"):
        volume_files("**", tmp_path / "x", "[[volume]] 1")
