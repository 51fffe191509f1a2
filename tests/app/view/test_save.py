"""Saving from the viewer never replaces what is there."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from airlight.app.view.save import Saver
from airlight.app.view.source import Source
from airlight.scene.builtin.cornell import cornell
from airlight.scene.image import Image


@pytest.fixture
def session():
    """What a saver asks of a session."""
    scene = cornell()
    state = SimpleNamespace(
        scene=scene, technique="direct", chosen_settings={}, message="", notice=""
    )
    image = Image(np.full((4, 6, 3), 0.5, np.float32), {})
    return SimpleNamespace(
        state=state,
        image=lambda: image,
        scene_now=lambda: scene,
        source=Source("builtin:cornell", scene),
    )


@pytest.mark.parametrize("ending", [".png", ".exr", ".toml"])
def test_files_folders_and_links_that_are_there_stay(session, tmp_path, ending):
    there = [tmp_path / f"{session.state.scene.name}-view-000{k}{ending}" for k in range(1, 6)]
    there[0].write_bytes(b"mine")
    there[1].mkdir()
    there[2].symlink_to(there[0])
    there[3].symlink_to(tmp_path / "nowhere")
    saver = Saver(session, tmp_path)
    path = saver.save_scene() if ending == ".toml" else saver.save_image(ending)
    assert path == there[4] and path.stat().st_size > 20
    assert session.state.notice == f"saved {path}" and session.state.message == ""
    assert there[0].read_bytes() == b"mine" and there[1].is_dir()
    assert there[2].is_symlink() and there[3].is_symlink()
    assert not (tmp_path / "nowhere").exists()
    assert sorted(file.name for file in tmp_path.iterdir()) == [file.name for file in there]


def test_a_folder_full_of_saved_images_is_one_message(session, tmp_path, monkeypatch):
    monkeypatch.setattr("os.path.lexists", lambda path: True)
    assert Saver(session, tmp_path).save_image(".png") is None
    assert "ten thousand images are here already" in session.state.message
    assert not list(tmp_path.iterdir())
