"""Checks of a scene file's values, apart from any file."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import checks
from airlight.scene.io.toml_schema import (
    Table,
    check_table,
    fraction,
    matrix16,
    mean_cosine,
    scale_vec3,
    unit_rgb,
)
from airlight.scene.keys import Key, one_of

LIGHT = Table(
    "lamp",
    "A lamp.",
    (Key("kind", one_of("bulb", "tube"), "text", "its kind", required=True),),
    repeated=True,
    variant_key="kind",
    variants={
        "bulb": (Key("watts", checks.number, "number", "its power", "W", required=True),),
        "tube": (Key("length", checks.number, "number", "its length", "m"),),
    },
)


def test_only_what_is_set_comes_back():
    assert check_table(LIGHT, {"kind": "tube"}, "[[lamp]] 1") == {"kind": "tube"}
    assert check_table(LIGHT, {"kind": "bulb", "watts": 3}, "x") == {"kind": "bulb", "watts": 3.0}


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (7, "[[lamp]] 2 must be a table of keys, not 7"),
        ({}, "[[lamp]] 2 has no kind. It is text."),
        ({"kind": "bulb"}, "[[lamp]] 2 (bulb) has no watts. It is its power (number, W)."),
        (
            {"kind": "bulb", "wats": 3},
            "unknown key 'wats' in [[lamp]] 2 (bulb). Did you mean 'watts'?",
        ),
        (
            {"kind": "tube", "watts": 3},
            "unknown key 'watts' in [[lamp]] 2 (tube). Known: kind, length.",
        ),
    ],
)
def test_messages(raw, expected):
    with pytest.raises(SceneError) as caught:
        check_table(LIGHT, raw, "[[lamp]] 2")
    assert str(caught.value) == expected


def test_header_says_whether_there_can_be_several():
    assert LIGHT.header == "[[lamp]]"
    assert Table("air", "", ()).header == "[air]"


def test_one_factor_or_three():
    assert scale_vec3(2, "scale") == (2.0, 2.0, 2.0)
    assert scale_vec3([1, -2, 3], "scale") == (1.0, -2.0, 3.0)
    with pytest.raises(SceneError, match="no factor may be zero"):
        scale_vec3([1, 0, 1], "scale")
    with pytest.raises(SceneError, match="must be three numbers, not True"):
        scale_vec3(True, "scale")


def test_matrices_are_row_major():
    matrix = matrix16([1, 0, 0, 7, 0, 1, 0, 8, 0, 0, 1, 9, 0, 0, 0, 1], "matrix")
    np.testing.assert_array_equal(matrix[:3, 3], [7, 8, 9])


def test_ranges():
    assert fraction(1, "roughness") == 1.0
    assert unit_rgb(0.5, "base_color") == (0.5, 0.5, 0.5)
    assert mean_cosine(-0.5, "g") == (-0.5, -0.5, -0.5)
    with pytest.raises(SceneError, match=r"roughness = 1\.5 is outside \[0, 1\]"):
        fraction(1.5, "roughness")
    with pytest.raises(
        SceneError, match=r"^medium: g = \[0\.0, 1\.0, 0\.0\] must lie in \(-1, 1\)$"
    ):
        mean_cosine([0, 1, 0], "medium: g")
