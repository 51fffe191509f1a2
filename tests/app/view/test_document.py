"""What is opened at a viewer: scenes, dropped files, maps; a broken one costs a message."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.view.document import Document
from airlight.app.view.save import Saver
from airlight.app.view.source import Source
from airlight.app.view.state import ViewState
from airlight.scene.builtin.cornell import cornell
from airlight.scene.image import Image
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
