"""Checks of a scene file's values, apart from any file."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.toml_schema import (
    MATRIX,
    MEAN_COSINE,
    SCALE,
    Table,
    check_table,
)
from airlight.scene.keys import FRACTION, NUMBER, REFLECTANCE, Key, one_of

LIGHT = Table(
    "lamp",
    "A lamp.",
    (Key("kind", one_of("bulb", "tube"), "its kind", required=True),),
    repeated=True,
    variant_key="kind",
    variants={
        "bulb": (Key("watts", NUMBER, "its power", "W", required=True),),
        "tube": (Key("length", NUMBER, "its length", "m"),),
    },
)


def test_only_what_is_set_comes_back():
    assert check_table(LIGHT, {"kind": "tube"}, "[[lamp]] 1") == {"kind": "tube"}
    assert check_table(LIGHT, {"kind": "bulb", "watts": 3}, "x") == {"kind": "bulb", "watts": 3.0}


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (7, "[[lamp]] 2 must be a table of keys, not 7"),
        ({}, '[[lamp]] 2 has no kind. It is "bulb" or "tube".'),
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
    assert SCALE.check(2, "scale") == (2.0, 2.0, 2.0)
    assert SCALE.check([1, -2, 3], "scale") == (1.0, -2.0, 3.0)
    with pytest.raises(SceneError, match="no factor may be zero"):
        SCALE.check([1, 0, 1], "scale")
    with pytest.raises(SceneError, match="must be three numbers, not True"):
        SCALE.check(True, "scale")


def test_matrices_are_row_major():
    matrix = MATRIX.check([1, 0, 0, 7, 0, 1, 0, 8, 0, 0, 1, 9, 0, 0, 0, 1], "matrix")
    np.testing.assert_array_equal(matrix[:3, 3], [7, 8, 9])


def test_ranges():
    assert FRACTION.check(1, "roughness") == 1.0
    assert REFLECTANCE.check(0.5, "base_color") == (0.5, 0.5, 0.5)
    assert MEAN_COSINE.check(-0.5, "g") == (-0.5, -0.5, -0.5)
    with pytest.raises(SceneError, match=r"roughness = 1\.5 is outside \[0, 1\]"):
        FRACTION.check(1.5, "roughness")
    with pytest.raises(
        SceneError, match=r"^medium: g = \[0\.0, 1\.0, 0\.0\] must lie in \(-1, 1\)$"
    ):
        MEAN_COSINE.check([0, 1, 0], "medium: g")
