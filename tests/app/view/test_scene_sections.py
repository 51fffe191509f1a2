"""The panel's widgets of lights: every field of an area light, with undo and a scene file of it."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import pytest

from airlight.app.view.history import History
from airlight.app.view.scene_sections import lights
from airlight.app.view.state import ViewState, structure
from airlight.app.view.widgets import Section, told
from airlight.scene import AreaLight, Camera, Mesh, PointLight, Scene
from airlight.scene.io import load
from airlight.scene.io.toml_text import scene_text
from airlight.scene.shapes import box

SQUARE = AreaLight((0.0, 2.0, 0.0), (3.0, 3.0, 3.0))
MESHES = (Mesh(box()),)
FILE = """
[[mesh]]
shape = "box"
[[light]]
type = "area"
position = [0, 2, 0]
radiance = 3
"""


def state_of(light) -> ViewState:
    return ViewState(Scene(meshes=MESHES, lights=(light,), camera=Camera((3.0, 2.0, 4.0))))


def offered(light) -> set[str]:
    widgets = lights(state_of(light))
    return {w.key.split(".")[2] for w in widgets if w.key.startswith("light.")}


def change(state: ViewState, key: str, value) -> bool:
    return told([Section("lights", tuple(lights(state)))], f"light.0.{key}", value)


def test_an_area_light_offers_what_its_shape_has():
    flat = {"position", "radiance", "shape", "reflectance", "two_sided", "visible"}
    assert offered(SQUARE) == flat | {"up", "size"}
    assert offered(replace(SQUARE, shape="disk")) == flat | {"radius"}
    assert offered(replace(SQUARE, shape="sphere")) == (flat | {"radius"}) - {"two_sided"}
    assert "reflectance" not in offered(replace(SQUARE, visible=False))


@pytest.mark.parametrize(
    ("key", "value", "field", "then"),
    [
        ("shape", "disk", "shape", "disk"),
        ("up", [90.0, 0.0], "up", (1.0, 0.0, 0.0)),
        ("size", [2.0, 0.5], "size", (2.0, 0.5)),
        ("reflectance", [0.2, 0.4, 0.6], "reflectance", (0.2, 0.4, 0.6)),
        ("two_sided", True, "two_sided", True),
        ("visible", False, "visible", False),
        ("radiance", 6.0, "radiance", (6.0, 6.0, 6.0)),
    ],
)
def test_a_field_is_changed_undone_and_written_into_a_scene_file(key, value, field, then, tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(FILE)
    original = load(path)
    assert original.lights == (SQUARE,)
    state = ViewState(original)
    history = History(state)
    assert change(state, key, value)
    (light,) = state.scene.lights
    assert getattr(light, field) == pytest.approx(then)
    assert {name for name, was in vars(SQUARE).items() if getattr(light, name) != was} == {field}

    copied = tmp_path / "copied.toml"
    copied.write_text(scene_text(state.scene, original, str(path), tmp_path))
    assert field in tomllib.loads(copied.read_text())["light"][0]
    (read,) = load(copied).lights
    assert getattr(read, field) == pytest.approx(then)

    history.undo(state)
    assert state.scene is original


def test_up_is_a_line_which_stays_where_it_is_shown():
    """`up` and its opposite are one rectangle: a pad of the upper half shows all there are."""
    for up in ((0.0, 0.0, -1.0), (0.6, -0.8, 0.0), (0.0, 1.0, 0.0)):
        state = state_of(replace(SQUARE, direction=(0.0, 0.0, 1.0), up=up))
        pad = next(w for w in lights(state) if w.key == "light.0.up")
        assert pad.value[1] >= 0.0
        assert change(state, "up", list(pad.value))
        after = state.scene.lights[0].up
        assert after == pytest.approx(up, abs=1e-9) or after == pytest.approx(
            tuple(-v for v in up), abs=1e-9
        )


def test_what_a_renderer_cannot_follow_needs_another_and_what_it_can_does_not():
    before = structure(state_of(SQUARE))
    for others in (
        {"shape": "disk"},
        {"reflectance": (0.5, 0.5, 0.5)},
        {"two_sided": True},
        {"visible": False},
    ):
        assert structure(state_of(replace(SQUARE, **others))) != before, others
    for same in ({"position": (1.0, 2.0, 0.0)}, {"size": (2.0, 2.0)}, {"up": (1.0, 0.0, 0.0)}):
        assert structure(state_of(replace(SQUARE, **same))) == before, same


def test_a_point_becomes_a_ball_with_soft_shadows():
    state = state_of(PointLight((0.0, 2.0, 0.0), (5.0, 5.0, 5.0)))
    before = structure(state)
    assert change(state, "radius", 0.003)
    assert state.scene.lights[0].radius == pytest.approx(0.003)
    assert structure(state) != before
