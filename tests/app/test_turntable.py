"""`airlight turntable`: once around, evenly, with the sun standing still."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import PIL.Image
import pytest

from airlight.app.cli import run
from airlight.app.turntable import around
from airlight.scene import Mesh, Scene
from airlight.scene.io import load, with_defaults
from airlight.scene.shapes import box

OBJ = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SMALL = ["-t", "direct", "--size", "32x20", "--samples", "1", "-q", "-D", "shadow_resolution=64"]


@pytest.fixture
def model(tmp_path):
    file = tmp_path / "model.obj"
    file.write_text(OBJ)
    return file


def test_the_camera_goes_around_the_model_at_its_height_and_distance(model):
    scene = around(load(model, ground=True), 4.0, 10.0)
    eyes = np.array([scene.at(k / 10.0).camera.position for k in range(41)])
    targets = np.array([scene.at(k / 10.0).camera.target for k in range(41)])
    assert np.allclose(eyes[0], scene.camera.position)
    assert np.allclose(eyes[40], eyes[0])
    assert np.ptp(eyes[:, 1]) < 1e-9
    # Every frame looks at one point, from equally far, a fortieth of a turn on.
    pivot = (eyes[0] + eyes[20]) / 2.0
    flat = (eyes - pivot)[:, [0, 2]]
    assert np.ptp(np.linalg.norm(flat, axis=1)) < 1e-9
    angles = np.unwrap(np.arctan2(flat[:, 1], flat[:, 0]))
    assert np.allclose(np.abs(np.diff(angles)), 2.0 * np.pi / 40.0)
    low, high = scene.meshes[0].world_bounds
    assert np.all(pivot[[0, 2]] > low[[0, 2]])
    assert np.all(pivot[[0, 2]] < high[[0, 2]])
    assert np.allclose(np.linalg.norm(targets - eyes, axis=1), np.linalg.norm(targets[0] - eyes[0]))
    assert scene.at(1.7).lights is scene.lights


def test_a_camera_whose_target_is_near_goes_around_the_model_all_the_same(model):
    scene = load(model)
    eye = np.array(scene.camera.position)
    look = np.subtract(scene.camera.target, eye)
    near = replace(scene.camera, target=tuple(eye + 0.01 * look))
    far_side = around(replace(scene, camera=near), 1.0, 2.0).at(0.5).camera.position
    usual = around(scene, 1.0, 2.0).at(0.5).camera.position
    assert np.allclose(far_side, usual)


def test_within_walls_it_turns_on_the_spot():
    scene = around(load("builtin:room"), 1.0, 4.0)
    quarter = scene.at(0.25).camera
    assert quarter.position == pytest.approx(scene.camera.position)
    look, was = (np.subtract(c.target, c.position) for c in (quarter, scene.camera))
    assert look[1] == pytest.approx(was[1])
    assert float(look[[0, 2]] @ was[[0, 2]]) == pytest.approx(0.0, abs=1e-9)


def smoke_scene(folder):
    """Smoke beside a box, whose density doubles in a second."""
    for k in (1, 2):
        density = np.full((2, 2, 2), float(k), np.float32)
        np.savez(folder / f"s.{k}.npz", density=density, bounds=[[4, 0, 0], [6, 2, 2]])
    (folder / "a.toml").write_text(
        '[[mesh]]\nshape = "box"\n[[volume]]\nsequence = "s.*.npz"\nsequence_fps = 1\n'
        "sigma_t = 1\n[camera]\nposition = [0, 1, 9]\ntarget = [0, 1, 0]\n"
        "[[camera.key]]\ntime_s = 0\nposition = [0, 1, 9]\n"
        "[[camera.key]]\ntime_s = 1\nposition = [0, 5, 9]\n"
    )
    return folder / "a.toml"


def test_what_moves_plays_where_it_is_asked_for(tmp_path):
    read = load(smoke_scene(tmp_path))
    for plays, most in ((True, 2.0), (False, 1.0)):
        later = around(read, 4.0, 10.0, plays=plays).at(1.0)
        assert later.volumes[0].density.max() == most
        # A quarter of the turn, at the same height: the camera's own motion is the turn.
        assert later.camera.position[1] == pytest.approx(read.camera.position[1])


def test_what_moves_and_is_static_is_told(tmp_path, capsys, gpu):
    out = ["-o", str(tmp_path / "out"), "--seconds", "1", "--fps", "1", *SMALL]
    scene = str(smoke_scene(tmp_path))
    assert run(["turntable", scene, *out]) == 0
    assert "what moves in the scene is static: --play" in capsys.readouterr().err
    (tmp_path / "more").mkdir()
    out[1] = str(tmp_path / "more")
    assert run(["turntable", scene, *out, "--play"]) == 0
    assert "--play" not in capsys.readouterr().err
    # A camera's own motion is no motion of the scene.
    still = (tmp_path / "a.toml").read_text().replace('[[volume]]\nsequence = "s.*.npz"', "#")
    still = still.replace("sequence_fps = 1\n", "").replace("sigma_t = 1\n", "")
    (tmp_path / "b.toml").write_text(still)
    out[1] = str(tmp_path / "other")
    assert load(tmp_path / "b.toml").animation is not None
    assert run(["turntable", str(tmp_path / "b.toml"), *out]) == 0
    assert "--play" not in capsys.readouterr().err


def test_frames_are_graded_and_written_as_those_of_sequences(model, tmp_path, gpu):
    grade = tmp_path / "black.cube"
    grade.write_text("LUT_3D_SIZE 2\n" + "0 0 0\n" * 8)
    made = ["turntable", str(model), "--seconds", "1", "--fps", "1", *SMALL]
    assert run([*made, "-o", str(tmp_path / "graded"), "--lut", str(grade)]) == 0
    (frame,) = (tmp_path / "graded").glob("*.png")
    assert not np.asarray(PIL.Image.open(frame)).any()
    assert run([*made, "-o", str(tmp_path / "raw"), "--format", "exr"]) == 0
    assert len(list((tmp_path / "raw").glob("*.exr"))) == 1


def test_frames_show_it_from_all_sides(model, tmp_path):
    out = tmp_path / "spin"
    assert (
        run(["turntable", str(model), "-o", str(out), "--seconds", "1", "--fps", "4", *SMALL]) == 0
    )
    frames = [np.asarray(PIL.Image.open(f), int) for f in sorted(out.glob("*.png"))]
    assert len(frames) == 4
    for one, other in zip(frames, [*frames[1:], frames[0]], strict=True):
        assert np.abs(one - other).mean() > 2.0
    # The model is seen before the backdrop, which is alike in the upper corners.
    for frame in frames:
        other = np.abs(frame - frame[0, 0]).max(axis=-1) > 6
        assert other.mean() > 0.04
        assert not other[0].any() and not other[:, 0].any()


@pytest.mark.parametrize("size", [(6.0, 1.0, 0.5), (0.3, 4.0, 0.3), (5.0, 0.2, 5.0)])
def test_what_the_first_frame_shows_whole_stays_whole(size):
    matrix = np.diag((*size, 1.0))
    bare = with_defaults(Scene(meshes=(Mesh(box(), world_from_object=matrix),)))
    scene = around(bare, 1.0, 24.0)
    corners = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, 8).T * size
    reach = []
    for k in range(24):
        camera = scene.at(k / 24.0).camera
        forward = np.subtract(camera.target, camera.position)
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, (0, 1, 0))
        right /= np.linalg.norm(right)
        offset = corners - camera.position
        across = np.maximum(abs(offset @ right) * 0.75, abs(offset @ np.cross(right, forward)))
        reach.append((across / (offset @ forward)).max() / np.tan(np.radians(15.0)))
    assert max(reach) <= 1.001
    # A camera that shows a part of it stays where its author put it.
    near = replace(bare.camera, fov_y_deg=5.0)
    assert around(replace(bare, camera=near), 1.0, 24.0).camera == near


@pytest.mark.needs("av")
def test_a_video(model, tmp_path):
    video = tmp_path / "spin.mp4"
    assert (
        run(["turntable", str(model), "-o", str(video), "--seconds", ".5", "--fps", "4", *SMALL])
        == 0
    )
    assert video.stat().st_size > 500
    assert not (tmp_path / "spin.mp4.frames").exists()


def test_a_bad_output_is_refused_before_any_work(model, tmp_path, capsys):
    assert run(["turntable", str(model), "-o", str(tmp_path / "a.gif")]) == 2
    assert "'.gif' is no kind of video" in capsys.readouterr().err
