"""Options beside a file: of which kinds each is, refused or left out elsewhere."""

from __future__ import annotations

import pytest

from airlight.errors import SceneError
from airlight.scene.io.model_options import fitting_options, left_open, model_keys

ALL = {"up": "z", "scale": 2.0, "grid": "ql", "channels": "r", "variant": "red"}
ALL["sequence_fps"] = 6.0
ALL |= {"parameters": {"spp": 4}, "sun": "30,120", "ground": True}


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("a.vdb", {"up", "scale", "grid", "channels", "sequence_fps"}),
        ("a.GLB", {"up", "scale", "variant"}),
        ("a.xml", {"parameters"}),
        ("a.toml", set()),
        ("builtin:smoke", set()),
    ],
)
def test_each_kind_has_options_of_its_own(file, names):
    fitting = fitting_options(file, ALL)
    assert set(fitting) == names | {"sun", "ground"}
    # What fits is taken, and what does not is refused by name.
    given = {name: fitting[name] for name in names}
    assert set(model_keys(file, **given)) == names
    for name in set(ALL) - names - {"sun", "ground"}:
        with pytest.raises(SceneError, match=f"{name} (is|are) for"):
            model_keys(file, **{name: ALL[name]})


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("a.obj", ("up", "scale")),
        ("a.STL", ("up", "scale")),
        ("a.vdb", ("up", "scale")),
        ("a.vti", ("up", "scale")),
        ("a.glb", ()),
        ("a.usda", ()),
        ("a.nc", ()),
        ("a.xml", ()),
        ("a.toml", ()),
        ("builtin:smoke", ()),
    ],
)
def test_what_files_leave_open(file, names):
    assert left_open(file) == names


def test_a_height_that_was_taken_is_open():
    told = "a.nc: the first of its axes is taken as the height (--up y takes y as up)"
    assert left_open("a.nc", (told,)) == ("up",)
