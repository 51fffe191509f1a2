"""What is opened at a viewer: scenes, dropped files, maps; a broken one costs a message."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.view.document import Document
from airlight.app.view.save import Saver
from airlight.app.view.sections import _placing
from airlight.app.view.source import Source
from airlight.app.view.state import ViewState
from airlight.scene.builtin.cornell import cornell
from airlight.scene.image import Image
from airlight.scene.io import load
from airlight.scene.io.images import save_image


@pytest.fixture
def document():
    scene = cornell()
    return Document(Source("builtin:cornell", scene), ViewState(scene, "direct"))


def test_another_scene_is_opened_with_its_camera_and_nothing_to_undo(document):
    document.state.settings, document.state.light = {"direct": {"resolution": 8}}, 2
    document.open("builtin:atrium")
    assert document.state.scene.name == "atrium"
    assert document.controls.camera == document.state.scene.camera
    assert (document.state.settings, document.state.light) == ({}, 0)
    assert document.state.technique == "direct"
    assert not document.history.can_undo


def test_what_cannot_be_opened_is_said_and_the_scene_stays(document, tmp_path):
    (tmp_path / "bad.toml").write_text("[camera")
    for name in ("builtin:cornel", str(tmp_path / "bad.toml"), str(tmp_path / "none.glb")):
        document.state.message = ""
        document.drop(name)
        assert document.state.message != ""
        assert document.state.scene.name == "cornell"


def test_a_dropped_map_becomes_the_environment_and_can_be_undone(document, tmp_path):
    path = tmp_path / "sky.hdr"
    save_image(Image(np.full((4, 8, 3), 2.0, np.float32), {}), path)
    document.drop(str(path))
    environment = document.state.scene.environment
    assert environment.map.shape == (4, 8, 3)
    assert environment.source == str(path.resolve())
    text = Saver(document, tmp_path)._text(tmp_path)
    assert 'file = "sky.hdr"' in text
    document.undo()
    assert document.state.scene.environment is not environment
    assert "sky.hdr" not in Saver(document, tmp_path)._text(tmp_path)
    document.drop(str(path), stays=False)  # what a page brought is gone when the viewer is
    assert "sky.hdr" not in Saver(document, tmp_path)._text(tmp_path)
    document.drop(str(tmp_path / "none.exr"))
    assert "none.exr" in document.state.message


def test_files_beside_the_scene_and_shipped_ones_can_be_chosen(tmp_path):
    beside = ("a.toml", "b.glb", "a_cloud.nc", "plume.vti")
    for name in (*beside, "notes.txt", "numbers.npy"):
        (tmp_path / name).write_text("")
    places = Source(str(tmp_path / "a.toml"), cornell()).places()
    assert places[:4] == tuple(str(tmp_path / name) for name in beside)  # grids come last
    assert "builtin:atrium" in places
    assert not any("notes" in place or "numbers" in place for place in places)


def opened(path) -> Document:
    scene = load(path)
    return Document(Source(str(path), scene), ViewState(scene, "direct"))


def placing(document) -> dict:
    return {widget.key: widget for widget in _placing(document)}


def test_a_model_is_turned_and_scaled_in_the_panel(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 0 20\nv 0 1 0\nf 1 2 3\nf 1 3 4\n")
    document = opened(path)
    assert {key: w.value for key, w in placing(document).items()} == {"up": "y", "unit": "metres"}
    document.state.settings = {"direct": {"resolution": 8}}
    placing(document)["up"].change("z")
    placing(document)["unit"].change("centimetres")
    now = placing(document)
    assert (now["up"].value, now["unit"].value) == ("z", "centimetres")
    # As if it had been opened so, but for what was chosen here.
    expected = load(path, up="z", scale=0.01)
    np.testing.assert_array_equal(document.state.scene.bounds, expected.bounds)
    assert document.controls.camera == expected.camera
    assert document.state.settings and not document.history.can_undo
    text = Saver(document, tmp_path)._text(tmp_path)
    assert 'up = "z"' in text and "scale = 0.01" in text
    assert document.source.watch.changed() is False


def test_a_unit_of_ones_own_is_among_the_choices(tmp_path):
    np.save(tmp_path / "a.npy", np.ones((3, 4, 5), np.float32))
    scene = load(tmp_path / "a.npy", scale=0.5)
    source = Source(str(tmp_path / "a.npy"), scene, {"scale": 0.5})
    unit = placing(Document(source, ViewState(scene, "direct")))["unit"]
    assert unit.value == "0.5 m" and "inches" in unit.choices


def test_what_says_how_it_lies_has_no_choice_and_what_cannot_be_is_said(document, tmp_path):
    assert placing(document) == {}
    (tmp_path / "a.toml").write_text('[[mesh]]\nshape = "box"\n')
    assert placing(opened(tmp_path / "a.toml")) == {}
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    gone = opened(path)
    path.unlink()
    placing(gone)["up"].change("z")
    assert "a.obj: file not found" in gone.state.message
    assert placing(gone)["up"].value == "y"
