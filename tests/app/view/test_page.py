"""The panel in a page: what it is told, and what it may say."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from airlight.app.view.document import Document
from airlight.app.view.page import Page
from airlight.app.view.source import Source
from airlight.app.view.state import ViewState
from airlight.app.view.uploads import Uploads
from airlight.scene.builtin.cornell import cornell
from airlight.scene.io.files import bound_of

PARTS = dict(type="file", name="../../etc/a b.glb", parts=2)


class Desk(Document):
    """A session without a device."""

    renderer, progress, status, share = None, "", "as fast as can be", 0.0
    layers, times_ms = ("image",), {}

    def __init__(self) -> None:
        scene = cornell()
        super().__init__(Source("builtin:cornell", scene), ViewState(scene))
        self.fine = SimpleNamespace(message="")


@pytest.fixture
def page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = Page(Desk(), lambda message: made.said.append(json.loads(json.dumps(message))))
    made.said = []
    return made


def widgets(page) -> dict:
    panel = [m for m in page.said if m["type"] == "panel"][-1]
    return {w["key"]: w for section in panel["sections"] for w in section["widgets"]}


def test_a_page_that_says_hello_is_told_everything_and_then_only_what_changes(page):
    assert page.heard({"type": "hello", "shown": True})
    page.render()
    assert [m["type"] for m in page.said] == ["status", "panel", "marks"]
    assert page.said[0]["shown"] is True
    page.said.clear()
    page.render()
    assert page.said == []
    page.session.state.message = "so much is wrong"
    page.render()
    assert [m["type"] for m in page.said] == ["status"]
    page.heard({"type": "hello"})
    page.render()
    assert {m["type"] for m in page.said} == {"status", "panel", "marks"}


def test_every_widget_of_the_panel_can_be_set_to_what_it_stands_at(page):
    page.render()
    for key, widget in widgets(page).items():
        if widget["kind"] in ("button", "bar", "chart", "choice"):
            continue
        page.heard({"type": "set", "key": key, "value": widget["value"]})
        assert page.session.state.message == "", key


def test_what_was_noted_of_the_file_can_be_read_in_the_panel(page):
    state = page.session.state
    state.scene = replace(state.scene, warnings=("its array 'soot' is the density", "no light"))
    page.render()
    sections = [m for m in page.said if m["type"] == "panel"][-1]["sections"]
    (notes,) = (s for s in sections if s["name"] == "notes on the file (2)")
    assert [(w["kind"], w["value"]) for w in notes["widgets"]] == [
        ("note", "its array 'soot' is the density"),
        ("note", "no light"),
    ]
    page.heard({"type": "set", "key": "note.0", "value": "other"})
    assert state.scene.warnings[1] == "no light"


def test_a_change_arrives_and_nonsense_does_not(page):
    hands = []
    page.touched = lambda: hands.append(1)
    state = page.session.state
    page.heard({"type": "set", "key": "technique", "value": "lpv"})
    assert (state.technique, len(hands)) == ("lpv", 1)
    for value in ("no such", 3, None, ["lpv"]):
        page.heard({"type": "set", "key": "technique", "value": value})
    page.heard({"type": "set", "key": ["technique"], "value": "single"})
    page.heard({"type": "set"})
    assert state.technique == "lpv"
    assert not page.heard({"type": "pointer_down"})
    assert not page.heard({"type": ["set"]})
    assert not page.heard("set")


def test_fingers_bring_the_camera_nearer_and_move_it(page):
    before = page.session.controls.camera
    page.heard({"type": "pinch", "dx": 0.0, "dy": 0.0, "scale": 1.5})
    now = page.session.controls.camera

    def away(c):
        return np.linalg.norm(np.subtract(c.target, c.position))

    assert away(now) == pytest.approx(away(before) / 1.5, rel=0.05)
    for scale in (0.0, float("nan"), "2", True, 1e9):
        page.heard({"type": "pinch", "dx": 0.0, "dy": 0.0, "scale": scale})
    assert page.session.controls.camera == now


def test_the_scene_file_is_copied_by_the_page(page):
    page.heard({"type": "set", "key": "copy", "value": None})
    copied = [m for m in page.said if m["type"] == "copy"]
    assert len(copied) == 1
    assert "[camera]" in copied[0]["text"]


def piece(part: int, data: bytes, **more) -> dict:
    return {**PARTS, "part": part, "data": base64.b64encode(data).decode(), **more}


def test_a_file_comes_in_pieces_into_a_folder_of_its_own():
    opened = []
    uploads = Uploads(lambda name: opened.append((Path(name), Path(name).read_bytes())))
    uploads.take(piece(0, b"glTF"))
    assert opened == []
    uploads.take(piece(1, b"rest"))
    ((path, data),) = opened
    assert (path.name, data) == ("a-b.glb", b"glTFrest")
    assert path.parent.name.startswith("airlight-")
    # A file that comes from elsewhere reads none of this machine's.
    assert bound_of(path.parent) == path.parent.resolve()
    uploads.close()
    assert not path.exists() and bound_of(path.parent) is None


def test_pieces_that_do_not_follow_are_dropped():
    opened = []
    uploads = Uploads(opened.append)
    for wrong in (
        piece(1, b"x"),
        piece(0, b"x", parts="2"),
        piece(0, b"x", name=3),
        {**piece(0, b"x"), "data": "not base64!"},
        {"type": "file"},
    ):
        uploads.take(wrong)
        uploads.take(piece(1, b"x"))
    uploads.take(piece(0, b"x"))
    uploads.take(piece(1, b"y", name="other.glb"))
    assert opened == []
