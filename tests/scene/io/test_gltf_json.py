"""Values that know where they stand."""

from __future__ import annotations

from pathlib import Path

import pytest

from airlight.errors import SceneError
from airlight.scene.io.gltf_json import Item

ITEM = Item(
    {"a": {"b": [1, {"c": 2.5}]}, "n": -1, "t": "x", "big": "y" * 100, "inf": float("inf")},
    "",
    Path("f.gltf"),
)


def test_places():
    assert ITEM.child("a").items("b")[1].place == "a.b[1]"
    assert ITEM.at("a", "nothing", "here").number("c", 7.0) == 7.0


@pytest.mark.parametrize(
    ("read", "message"),
    [
        (lambda i: i.integer("n"), "f.gltf: n: is -1, below 0"),
        (lambda i: i.integer("t"), "f.gltf: t: must be a whole number, not 'x'"),
        (lambda i: i.integer("inf"), "f.gltf: inf: must be a whole number, not inf"),
        (lambda i: i.child("a").items("b")[1].integer("c"), "must be a whole number, not 2.5"),
        (lambda i: i.child("a").integer("z"), "f.gltf: a: has no 'z'"),
        (lambda i: i.floats("n", 3, ()), "f.gltf: n: must be 3 finite numbers, not -1"),
        (lambda i: i.text("n"), "f.gltf: n: must be text, not -1"),
        (lambda i: i.items("t"), "f.gltf: t: must be a list, not 'x'"),
        (lambda i: i.child("n").child("x"), "f.gltf: n: must be an object, not -1"),
        (lambda i: i.items("big"), "not 'yyyyyyyyyy"),
        (lambda i: i.index("n", [1, 2], "things"), "is -1, below 0"),
    ],
)
def test_messages(read, message):
    with pytest.raises(SceneError) as error:
        read(ITEM)
    assert message in str(error.value)
    assert len(str(error.value)) < 120
