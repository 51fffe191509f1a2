"""Sequences of grids that grow: each file has its own box, between two files one holds both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight import Renderer, load, render
from airlight.app.cli import run
from airlight.app.sequence.frames import FrameMaker
from airlight.errors import SceneError
from airlight.lighting.reach import MadeFor
from airlight.scene import Emission, Volume
from airlight.scene.animation import file_sequence
from airlight.scene.animation.boxes import CommonBoxes, mixed, on_box
from airlight.scene.io import volumes
from airlight.scene.one_grid import GridBox
from airlight.scene.shown import changed, shutter_moments

SCENE = """
[camera]
position = [3.0, 2.0, 4.0]
target = [0.0, 0.5, 0.0]
exposure_stops = 0.0
[[mesh]]
shape = "quad"
scale = 4.0
[[light]]
type = "directional"
direction = [1.0, -1.0, -0.4]
irradiance = [10, 9, 8]
[[volume]]
sigma_t = 6
"""
SMALL = ((-0.4, 0.0, -0.4), (0.4, 0.4, 0.4))
LARGE = ((-0.6, 0.0, -0.4), (0.6, 0.8, 0.8))


def grid(size, seed=1):
    """(z, y, x) of `size` (x, y, z), nowhere empty."""
    return np.random.default_rng(seed).uniform(0.2, 1.0, size[::-1]).astype(np.float32)


@pytest.fixture
def growing(tmp_path):
    """A folder with a sequence of two files of voxels of .2 m, its scene and those of each file."""
    for k, (bounds, size) in enumerate(((SMALL, (4, 2, 4)), (LARGE, (6, 4, 6)))):
        np.savez(tmp_path / f"s{k}.npz", density=grid(size), albedo=grid(size, 2), bounds=bounds)
        (tmp_path / f"one{k}.toml").write_text(SCENE + f'file = "s{k}.npz"\n')
    text = SCENE + 'sequence = "s*.npz"\nsequence_fps = 1\n'
    (tmp_path / "all.toml").write_text(text)
    return tmp_path


def volume_at(scene, time_s):
    return scene.at(time_s).volumes[0]


def test_each_file_has_its_own_box(growing):
    scene = load(growing / "all.toml")
    for k in (1, 0):
        found, alone = volume_at(scene, float(k)), load(growing / f"one{k}.toml").volumes[0]
        assert found.bounds == alone.bounds
        np.testing.assert_array_equal(found.density, alone.density)
    # A moment that is the same stays the same value, so that nothing is solved again.
    at_end = scene.at(1.0)
    assert at_end.at(5.0).volumes[0] is at_end.volumes[0]


def test_between_two_files_a_box_holds_both(growing):
    scene = load(growing / "all.toml")
    found = volume_at(scene, 0.25)
    np.testing.assert_allclose(found.bounds, LARGE, atol=1e-6)
    wanted = 0.25 * grid((6, 4, 6))
    wanted[:4, :2, 1:5] += 0.75 * grid((4, 2, 4))
    np.testing.assert_allclose(found.density, wanted, rtol=1e-6)


def test_colours_follow_the_files_and_count_by_what_there_is(growing):
    text = (growing / "all.toml").read_text() + 'albedo_grid = "albedo"\n'
    (growing / "all.toml").write_text(text)
    scene = load(growing / "all.toml")
    assert not scene.warnings
    np.testing.assert_array_equal(volume_at(scene, 1.0).albedo_grid[..., 0], grid((6, 4, 6), 2))
    # Scattering is what is mixed.
    found = volume_at(scene, 0.5)
    wanted = 0.5 * grid((6, 4, 6)) * grid((6, 4, 6), 2)
    wanted[:4, :2, 1:5] += 0.5 * grid((4, 2, 4)) * grid((4, 2, 4), 2)
    np.testing.assert_allclose(found.albedo_grid[..., 0] * found.density, wanted, rtol=1e-5)


def test_one_box_for_all_files_is_kept(growing):
    text = SCENE + 'sequence = "s*.npz"\nsequence_fps = 1\nbounds = [[0, 0, 0], [1, 1, 1]]\n'
    (growing / "all.toml").write_text(text)
    scene = load(growing / "all.toml")
    with pytest.raises(SceneError) as caught:
        scene.at(1.0)
    problem = "its grid has 6 x 4 x 6 cells, the sequence's first has 4 x 2 x 4"
    assert caught.value.where == str(growing / "s1.npz")
    assert caught.value.problem == f"at 1 s: {problem}"
    assert caught.value.remedy == "Leave out bounds: each file says where it is."


def test_files_that_do_not_say_where_they_are_are_named(growing):
    np.savez(growing / "s1.npz", density=grid((4, 2, 4)))
    scene = load(growing / "all.toml")
    with pytest.raises(SceneError, match="does not say where it is, as others of the sequence do"):
        scene.at(1.0)


def test_images_are_those_of_the_files_alone(growing):
    scene = load(growing / "all.toml")
    with Renderer(scene, "pop", (24, 16)) as renderer:
        found = [renderer.frame(time=t).radiance for t in (0.0, 1.0, 0.0)]
    for k in range(2):
        alone = render(growing / f"one{k}.toml", "pop", (24, 16), samples=1)
        np.testing.assert_array_equal(found[k], alone.radiance)
    np.testing.assert_array_equal(found[2], found[0])


@pytest.mark.slow
def test_an_open_shutter_sees_boxes_that_change(growing):
    scene = load(growing / "all.toml")
    shut = replace(scene, camera=replace(scene.camera, shutter_s=0.5))
    # All of the shutter's moments fall on one file and its way to the next.
    with Renderer(shut, "pop", (24, 16)) as renderer:
        blurred = renderer.frame(time=0.0, samples=4).radiance
        ends = [renderer.frame(time=t, samples=4).radiance for t in (0.0, 2.0)]
    assert np.isfinite(blurred).all()
    np.testing.assert_array_equal(ends[0], blurred)
    assert np.abs(ends[1] - blurred).max() > 1e-3


def test_an_open_shutter_reads_each_file_once(growing, monkeypatch):
    for k in range(2, 6):
        np.savez(growing / f"s{k}.npz", density=grid((4, 2, 4 + k)), bounds=SMALL)
    scene = load(growing / "all.toml")
    shut = replace(scene, camera=replace(scene.camera, shutter_s=4.0))
    read, own = [], file_sequence._file_grids
    monkeypatch.setattr(file_sequence, "_file_grids", lambda *key: read.append(key[0]) or own(*key))
    for time in (0.5, 1.5):
        before = shut.at(time)
        _, moments = shutter_moments(before, changed(before), time, 16, {})
        assert len(list(moments)) == 16
    assert sorted(read) == sorted({*read})


def test_a_sequence_that_grows_goes_on_where_it_was_cut_off(gpu, growing, monkeypatch):
    """Frames on their own, after others, and after a run that broke off have the same bytes."""
    words = [
        "sequence",
        str(growing / "all.toml"),
        "-t",
        "pop",
        "--size",
        "24x16",
        "--samples",
        "1",
    ]
    words += ["--fps", "2", "-q", "-o"]
    assert run([*words, str(growing / "whole")]) == 0
    # The run ends before its third frame, half of which is written, in the middle of the growth.
    own, made = FrameMaker.save, []

    def broken(self, frame, path):
        if len(made) == 2:
            path.write_bytes(b"half a frame")
            raise KeyboardInterrupt
        made.append(frame)
        own(self, frame, path)

    monkeypatch.setattr(FrameMaker, "save", broken)
    run([*words, str(growing / "cut")])
    monkeypatch.setattr(FrameMaker, "save", own)
    assert len(list((growing / "cut").glob("frame-*.png"))) < 4
    assert run([*words, str(growing / "cut"), "--resume"]) == 0
    whole = sorted((growing / "whole").glob("frame-*.png"))
    assert len(whole) == 4
    for path in whole:
        assert (growing / "cut" / path.name).read_bytes() == path.read_bytes()


def test_grids_keep_what_they_hold_on_other_voxels():
    """Extinction, scattering and emission add up to the same on voxels that are shifted."""
    shape, bounds = (3, 4, 5), ((0.0, 0.0, 0.0), (5.0, 4.0, 3.0))
    colours = {"albedo_grid": grid((5, 4, 3), 4), "tint": grid((5, 4, 3), 5)}
    emission = Emission((1, 1, 1), grid=grid((5, 4, 3), 6))
    volume = Volume((1, 1, 1), grid((5, 4, 3), 3), bounds=bounds, emission=emission, **colours)
    own = GridBox(shape, bounds, np.eye(4))
    box = GridBox((5, 6, 7), ((-1.25, -1.5, -0.75), (5.75, 4.5, 4.25)), np.eye(4))
    moved = on_box(volume, box)
    assert moved.density.shape == box.shape and moved.bounds == box.bounds
    scattering = [v.density[..., None] * v.tint * v.albedo_grid for v in (volume, moved)]
    for before, after in (
        (volume.density, moved.density),
        (scattering[0], scattering[1]),
        (volume.emission.grid, moved.emission.grid),
    ):
        assert after.sum() == pytest.approx(before.sum(), rel=1e-5)
    assert on_box(volume, own) is volume
    # The mean of a volume and itself is itself.
    same = mixed(volume, volume, 0.5)
    np.testing.assert_allclose(same.density, volume.density, rtol=1e-6)
    np.testing.assert_allclose(same.albedo_grid, volume.albedo_grid, rtol=1e-5)


def test_a_file_turned_by_half_a_turn_is_refused(growing, monkeypatch):
    """Its matrix is a diagonal, too: its box would be inside out."""
    read = volumes.read_volume

    def turned(path, *names):
        found = read(path, *names)
        if path.name == "s1.npz":
            found = replace(found, world_from_volume=np.diag([-1.0, 1.0, -1.0, 1.0]))
        return found

    monkeypatch.setattr(volumes, "read_volume", turned)
    scene = load(growing / "all.toml")
    with pytest.raises(SceneError, match=r"s1\.npz.*turned otherwise"):
        volume_at(scene, 1.0)


def test_a_still_scene_has_no_common_boxes(growing):
    scene = load(growing / "one0.toml")
    assert CommonBoxes.at(scene, (0.0, 1.0)).on(scene) is scene


def test_volumes_that_are_given_keep_their_boxes_while_the_shutter_is_open(growing):
    scene = load(growing / "all.toml")
    shut = replace(scene, camera=replace(scene.camera, shutter_s=0.5))
    own = Volume((1, 1, 1), grid((3, 3, 3)), bounds=((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    shown = changed(shut.at(0.0), volumes=(own,))
    found, moments = shutter_moments(shut, shown, 0.0, 4, {"volumes": (own,)})
    assert found.volumes == (own,) and all(moment.volumes == (own,) for moment in moments)
    # Without them, boxes that change become one.
    found, moments = shutter_moments(shut, shut.at(0.0), 0.0, 4, {})
    every = [found, *moments]
    assert {moment.volumes[0].density.shape for moment in every} == {(6, 4, 6)}


def test_an_eye_far_out_is_reached_in_the_frame_whose_box_changes(growing):
    """A frame is the same whichever was drawn before it, in a medium that cameras go away in."""
    path = growing / "all.toml"
    fog = "[medium]\nsigma_s = 0.02\nbounds = [[-90, 0, -90], [90, 9, 990]]\n"
    path.write_text(path.read_text() + fog)
    scene = load(path)
    far = replace(scene, camera=replace(scene.camera, position=(0.0, 2.0, 400.0)))
    for shown in (scene, far):
        once = MadeFor(scene, follows_eye=True).showing(shown.at(1.0))
        assert once.first.volumes[0].density.shape == (6, 4, 6)
        assert once.showing(shown.at(1.0)) is once
    assert once.eye is not None


def test_only_boxes_decide_what_is_made_again(growing):
    """Frames do not depend on those before them: lights are made for as they were first."""
    text = (growing / "all.toml").read_text()
    keys = "[[light.key]]\ntime_s = 0\nirradiance = [1, 1, 1]\n"
    keys += "[[light.key]]\ntime_s = 1\nirradiance = [2, 2, 2]\n"
    (growing / "all.toml").write_text(text.replace("[[volume]]", keys + "[[volume]]"))
    scene = load(growing / "all.toml")
    made = MadeFor(scene)
    assert made.showing(scene.at(0.0)) is made
    again = made.showing(scene.at(1.0))
    assert again is not made and again.scene.lights == scene.lights
    assert again.scene.volumes[0].density.shape == (6, 4, 6)
    assert again.showing(scene.at(3.0)) is again
