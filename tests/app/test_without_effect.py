"""Options that have no effect on what they are given for say so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest

from airlight.app.cli import run
from airlight.app.options import display_doubts
from airlight.app.scene_options import camera_options, scene_options, with_camera
from airlight.errors import SceneError
from airlight.scene import Camera, Scene
from airlight.scene.animation import Animation
from airlight.scene.animation.tracks import OrbitTrack
from airlight.scene.fingerprint import fingerprint
from airlight.scene.io import load

FOR_FILES = "for mesh files and density grids"
FOR_MESHES = "for mesh files"
FOR_MITSUBA = "for Mitsuba's files"
NO_GROUND = "no ground was put under it: "
SAYS = NO_GROUND + "scene files say what there is"
DOES = ""
ALONE = "nothing to leave out"
"""It has no ground without the option either: what was asked for is what there is."""
FOR_GRIDS = "for density grids ("
OPTIONS = {
    "--up": ["--up", "z"],
    "--scale": ["--scale", ".5"],
    "--variant": ["--variant", "red"],
    "--sun": ["--sun", "30,120"],
    "--ground": ["--ground"],
    "--no-ground": ["--no-ground"],
    "--param": ["--param", "size=2"],
    "--grid": ["--grid", "smoke"],
    "--channels": ["--channels", "g"],
    "--sequence-fps": ["--sequence-fps", "2"],
}
EXPECTED = {
    "model.obj": [
        DOES,
        DOES,
        "only glTF files have variants",
        DOES,
        DOES,
        DOES,
        FOR_MITSUBA,
        FOR_GRIDS,
        FOR_GRIDS,
        FOR_GRIDS,
    ],
    "floor.obj": [
        DOES,
        DOES,
        "only glTF files have variants",
        DOES,
        NO_GROUND,
        ALONE,
        FOR_MITSUBA,
        FOR_GRIDS,
        FOR_GRIDS,
        FOR_GRIDS,
    ],
    "smoke.npy": [
        DOES,
        DOES,
        FOR_MESHES,
        DOES,
        DOES,
        ALONE,
        FOR_MITSUBA,
        "its only grid has no name",
        "there is no channel 'g'",
        "sequence_fps is left out",
    ],
    "scene.toml": [
        FOR_FILES,
        FOR_FILES,
        FOR_MESHES,
        DOES,
        SAYS,
        ALONE,
        FOR_MITSUBA,
        FOR_GRIDS,
        FOR_GRIDS,
        FOR_GRIDS,
    ],
    "scene.xml": [
        FOR_FILES,
        FOR_FILES,
        FOR_MESHES,
        DOES,
        SAYS,
        ALONE,
        DOES,
        FOR_GRIDS,
        FOR_GRIDS,
        FOR_GRIDS,
    ],
    "builtin:cornell": [
        FOR_FILES,
        FOR_FILES,
        FOR_MESHES,
        DOES,
        SAYS,
        ALONE,
        FOR_MITSUBA,
        FOR_GRIDS,
        FOR_GRIDS,
        FOR_GRIDS,
    ],
}
"""What each option of OPTIONS, in their order, does to a file, or the words that say why not."""


@click.command()
@scene_options()
def models(scene: str, model: dict[str, Any]) -> dict[str, Any]:
    """What commands that show a scene hand to `load`."""
    return model


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("kinds")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (made / "model.obj").write_text(corners)
    (made / "floor.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 4 3 2 1\n")
    np.save(made / "smoke.npy", np.ones((4, 4, 4), np.float32))
    (made / "scene.toml").write_text('[[mesh]]\nshape = "box"\n')
    (made / "scene.xml").write_text(
        '<scene version="3.0.0"><default name="size" value="1"/><shape type="cube">'
        '<transform name="to_world"><scale value="$size"/></transform></shape></scene>'
    )
    return made


def asked(*words: str) -> dict[str, Any]:
    """The keywords of `load` that options on a command line make."""
    return models.main(list(words), standalone_mode=False)


def test_every_option_that_says_how_a_scene_is_read_is_in_the_table():
    named = {o for p in models.params for o in (*p.opts, *p.secondary_opts) if o.startswith("-")}
    assert named == OPTIONS.keys()
    assert all(len(row) == len(OPTIONS) for row in EXPECTED.values())


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("name", EXPECTED)
def test_it_changes_the_scene_or_says_why_not(folder: Path, name: str, option: str):
    place = name if name.startswith("builtin:") else str(folder / name)
    expected = EXPECTED[name][list(OPTIONS).index(option)]
    usual = load(place, **asked(place))
    try:
        scene = load(place, **asked(place, *OPTIONS[option]))
    except SceneError as error:
        assert expected and expected in str(error)
        return
    told = set(scene.warnings) - set(usual.warnings)
    if option == "--ground" and expected == DOES and name.endswith(".obj"):
        assert fingerprint(scene) == fingerprint(usual)  # it stands on one without being asked
        assert fingerprint(scene) != fingerprint(load(place))
    elif expected == ALONE:
        assert fingerprint(scene) == fingerprint(usual) and not told
    elif expected == DOES:
        assert fingerprint(scene) != fingerprint(usual)
        assert not any("no ground" in text for text in told)
    else:
        assert any(expected in text for text in told)


CAMERA = {
    "--aperture": ({"aperture_m": 0.05}, "", ""),
    "--focus": ({"focus_m": 2.0}, "--focus does nothing", "--focus does nothing"),
    "--shutter": ({"shutter_s": 0.1}, "--shutter does nothing", ""),
}
"""Of each option of the camera what it gives, and what is said of a static and a moving scene."""


def test_every_option_of_the_camera_is_in_the_table():
    command = camera_options()(lambda: None)
    made = click.command()(command)
    assert {p.opts[0] for p in made.params} == CAMERA.keys()


@pytest.mark.parametrize("option", CAMERA)
def test_the_camera_says_what_does_nothing(option: str):
    changes, of_static, of_moving = CAMERA[option]
    moving = Scene(animation=Animation((OrbitTrack(Camera(), 1.0, None),), end_s=1.0, fps=10.0))
    for scene, expected in ((Scene(), of_static), (moving, of_moving)):
        told = with_camera(scene, changes).warnings
        assert len(told) == bool(expected) and all(expected in text for text in told)
    assert with_camera(Scene(), {"aperture_m": 0.1, "focus_m": 2.0}).warnings == ()


@pytest.mark.parametrize(
    ("suffix", "unused"),
    [(".png", ()), (".jpg", ()), (".exr", ("--lut",)),
     (".HDR", ("--exposure", "--tone-map", "--lut"))],
)  # fmt: skip
def test_linear_files_take_no_display(suffix: str, unused: tuple[str, ...]):
    given = {"exposure": 0.0, "tone_map": "aces", "lut": object()}
    told = display_doubts(suffix, given)
    assert len(told) == len(unused)
    assert all(name in text for name, text in zip(unused, told, strict=True))
    assert display_doubts(suffix, dict.fromkeys(given)) == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["view", "builtin:cornell", "--no-open"], "--open belong to --in browser"),
        (["view", "builtin:cornell", "--open"], "--open belong to --in browser"),
        (["figure", "clpv-5", "--quick", "--size", "9x9"], "leave out --size"),
        (["render", "builtin:cornell", "--time", "1", "-o"], "nothing moves"),
        (["render", "builtin:cornell", "--layers", "-o"], "--layers needs an .exr"),
        (["sequence", "builtin:smoke", "--layers", "-o"], "--layers needs --format exr"),
    ],
)
def test_options_of_another_kind_of_output_are_refused(words, said, capsys, tmp_path):
    ending = "" if words[0] == "sequence" else ".png"
    place = [str(tmp_path / f"out{ending}")] if words[-1] == "-o" else []
    assert run([*words, *place]) == 2
    assert said in capsys.readouterr().err
