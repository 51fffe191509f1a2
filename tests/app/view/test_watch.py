"""Edits are seen once, when they are whole; broken and missing files are no accident."""

from __future__ import annotations

import os

import numpy as np
import pytest

from airlight.app.view.source import Source
from airlight.app.view.watch import Watch, named_files
from airlight.scene import Scene
from airlight.scene.io import load
from airlight.scene.io.ledger import note_read, noted, stamp_of


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


def follow(watch: Watch, *paths) -> None:
    watch.follow({path: stamp_of(path) for path in paths})


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


def test_what_was_read_beside_is_followed_too(scene):
    mtl, png = scene.parent / "room.mtl", scene.parent / "wood.png"
    for path in (mtl, png):
        path.write_text("1")
    watch = Watch(scene, Clock())
    follow(watch, mtl, png, scene, scene.parent / "gone.png")
    assert edits(watch) == 0
    for number, path in enumerate((mtl, png), start=1):
        rewrite(path, "22", number * 10**18)
        assert edits(watch) == 1
    # A file that changed while the scene was loaded is an edit.
    rewrite(mtl, "333", 3 * 10**18)
    follow(watch, mtl)
    assert edits(watch) == 1


def test_a_texture_that_is_away_for_a_moment_is_followed_still(scene):
    png = scene.parent / "wood.png"
    png.write_text("1")
    watch = Watch(scene, Clock())
    follow(watch, png)
    png.unlink()
    assert edits(watch) <= 1
    # A scene that was loaded without it names it as it was: not there.
    follow(watch, png)
    for number in (1, 2):
        rewrite(png, "22", number * 10**18)
        assert edits(watch) == 1


def test_a_texture_saved_while_the_first_image_was_made_is_an_edit(scene):
    png = scene.parent / "wood.png"
    rewrite(png, "1", 10**18)
    watch = Watch(scene, Clock())
    with noted() as files:
        note_read(png)
        rewrite(png, "22", 2 * 10**18)
        note_read(png)
    watch.follow(files.stamps)
    assert edits(watch) == 1
    # The same of a viewer, whose watch begins when its scene has been read.
    assert edits(Watch(scene, Clock(), read=files.stamps)) == 1


def test_chunks_of_a_zarr_store_are_watched(tmp_path):
    store = tmp_path / "cloud.zarr"
    (store / "ql" / "c").mkdir(parents=True)
    rewrite(store / "ql" / "c" / "0", "1", 10**18)
    path = tmp_path / "scene.toml"
    path.write_text('[[volume]]\nfile = "cloud.zarr"\n')
    watch = Watch(path, Clock())
    for number, text in enumerate(("2", "33"), start=2):
        rewrite(store / "ql" / "c" / "0", text, number * 10**18)
        assert edits(watch) == 1
    assert edits(watch) == 0


def test_files_of_other_kinds_are_opened_without_options_that_they_have_not(tmp_path):
    np.savez(tmp_path / "a.npz", smoke=np.ones((2, 2, 2)), fog=np.ones((2, 2, 2)))
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "a.toml").write_text('[[mesh]]\nfile = "a.obj"\n')
    options = {"grid": "fog", "up": "z"}
    first = Source(str(tmp_path / "a.npz"), Scene(), options)
    assert first.again().volumes
    for name in ("a.obj", "a.toml"):
        other = first.opened(str(tmp_path / name))
        assert other.loaded.meshes and other.again().meshes
        # The first file is opened as it was.
        assert other.opened(first.name).loaded.volumes


def test_a_source_follows_the_materials_and_textures_of_its_models(tmp_path):
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
    (tmp_path / "a.mtl").write_text("newmtl m\nKd 1 0 0\n")
    (tmp_path / "a.toml").write_text('[[mesh]]\nfile = "a.obj"\n')
    source = Source(str(tmp_path / "a.toml"), Scene())
    assert source.again().meshes[0].material.base_color == (1, 0, 0)
    for file in (source, source.opened(str(tmp_path / "a.obj"))):
        file.watch._clock = Clock()
        rewrite(tmp_path / "a.mtl", "newmtl m\nKd 0 1 0\n", 10**18 + id(file) % 1000)
        assert edits(file.watch) == 1
    assert source.again().meshes[0].material.base_color == (0, 1, 0)


@pytest.mark.parametrize("kind", ["a.obj", "a.gltf"])
def test_a_texture_that_is_not_there_yet_is_followed(tmp_path, kind):
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
    (tmp_path / "a.mtl").write_text("newmtl m\nmap_Kd wood.png\n")
    (tmp_path / "a.gltf").write_text(GLTF)
    with noted() as files:
        loaded = load(tmp_path / kind)
    assert any("wood.png" in text for text in loaded.warnings)
    watch = Watch(tmp_path / kind, Clock(), files.stamps)
    rewrite(tmp_path / "wood.png", "1", 10**18)
    assert edits(watch) == 1


GLTF = """{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"mesh": 0}], "images": [{"uri": "wood.png"}], "textures": [{"source": 0}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
 "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
  "min": [0, 0, 0], "max": [1, 1, 0]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "buffers": [{"byteLength": 36, "uri":
  "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"""
