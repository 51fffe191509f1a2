"""Edits are seen once, when they are whole; broken and missing files are no accident."""

from __future__ import annotations

import os

import pytest

from airlight.app.view.watch import Watch, named_files


class Clock:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 1.0
        return self.now


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text('[[mesh]]\nfile = "room.obj"\n[environment]\nfile = "sky.exr"\n')
    (tmp_path / "room.obj").write_text("v 0 0 0\n")
    return path


def edits(watch: Watch) -> int:
    return sum(watch.changed() for _ in range(5))


def rewrite(path, text: str, ns: int) -> None:
    path.write_text(text)
    os.utime(path, ns=(ns, ns))


def test_an_edit_is_seen_once(scene):
    watch = Watch(scene, Clock())
    assert edits(watch) == 0
    rewrite(scene, scene.read_text() + "\n", 10**18)
    assert edits(watch) == 1
    assert edits(watch) == 0


def test_files_that_the_scene_names_are_watched(scene):
    watch = Watch(scene, Clock())
    rewrite(scene.parent / "room.obj", "v 1 0 0\n", 10**18)
    assert edits(watch) == 1
    # One that was missing and now exists, too: the last edit named it.
    (scene.parent / "new.obj").write_text("v 0 0 0\n")
    rewrite(scene, '[[mesh]]\nfile = "new.obj"\n', 2 * 10**18)
    assert edits(watch) == 1
    rewrite(scene.parent / "new.obj", "v 2 0 0\n", 3 * 10**18)
    assert edits(watch) == 1


def test_a_file_that_is_replaced_is_not_an_edit_until_it_is_back(scene):
    watch = Watch(scene, Clock())
    text = scene.read_text()
    scene.unlink()
    assert edits(watch) == 0
    rewrite(scene, text + "# new\n", 10**18)
    assert edits(watch) == 1


def test_a_file_still_being_written_waits(scene):
    watch = Watch(scene, Clock())
    rewrite(scene, "a", 10**18)
    assert not watch.changed()
    rewrite(scene, "a = 1", 2 * 10**18)
    assert not watch.changed()  # changed again: not yet quiet
    assert watch.changed()


def test_it_looks_no_more_often_than_the_interval(scene):
    watch = Watch(scene, lambda: 0.0)
    rewrite(scene, "", 10**18)
    assert not watch.changed()
    assert not watch.changed()


@pytest.mark.parametrize("text", ["[[mesh", "mesh = 3", "[[mesh]]\nfile = 7", "\xff"])
def test_a_broken_scene_names_only_itself(tmp_path, text):
    path = tmp_path / "scene.toml"
    path.write_bytes(text.encode("latin-1"))
    assert named_files(path) == {path}


def test_a_mesh_file_is_watched_alone(tmp_path):
    path = tmp_path / "room.obj"
    assert named_files(path) == {path}


def test_groups_of_lights_and_grids_of_a_sequence_are_watched(tmp_path):
    for name in ("lights.npz", "smoke.9.npy", "smoke.10.npy", "other.npy"):
        (tmp_path / name).write_bytes(b"1")
    path = tmp_path / "scene.toml"
    path.write_text(
        '[[light]]\ntype = "points"\nfile = "lights.npz"\n'
        '[[light]]\ntype = "point"\nposition = [0, 1, 0]\nintensity = 1\n'
        '[[volume]]\nsequence = "smoke.*.npy"\n[[volume]]\nsequence = "none.*.vdb"\n'
    )
    found = {file.name for file in named_files(path)}
    assert found == {"scene.toml", "lights.npz", "smoke.9.npy", "smoke.10.npy"}
    watch = Watch(path, Clock())
    for number, name in enumerate(("lights.npz", "smoke.10.npy"), start=1):
        (tmp_path / name).write_bytes(b"22")
        os.utime(tmp_path / name, ns=(number * 10**18, number * 10**18))
        assert edits(watch) == 1
