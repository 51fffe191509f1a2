"""Settings: values from a file or a command line, checked against the field they set."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from airlight.errors import SettingsError, SettingsWarning
from airlight.scene.settings import make_settings, setting


@dataclass(frozen=True)
class Knobs:
    resolution: int = setting(32, "cells along the longest side", low=2, high=256)
    gain: float = setting(1.0, "brightness", low=0.0)
    scheme: str = setting(
        "centroid", "propagation", choices=("centroid", "paper"), former={"faces": "centroid"}
    )
    is_clamped: bool = setting(False, "clamp intensities")
    centre: tuple[float, ...] = setting((0.0, 0.0, 0.0), "where", unit="m")


def test_defaults_hold_where_nothing_is_said():
    assert make_settings(Knobs, {}) == Knobs()


def test_text_from_a_command_line_is_parsed():
    knobs = make_settings(
        Knobs,
        {
            "resolution": "64",
            "gain": "0.5",
            "scheme": "paper",
            "is_clamped": "yes",
            "centre": "1,2,3",
        },
    )
    assert knobs == Knobs(64, 0.5, "paper", True, (1.0, 2.0, 3.0))
    assert isinstance(knobs.resolution, int)


def test_values_from_a_file_are_taken():
    assert make_settings(Knobs, {"resolution": 8, "gain": 2, "is_clamped": True}) == Knobs(
        8, 2.0, is_clamped=True
    )


def test_a_choice_that_is_gone_is_taken_as_another_one_and_told():
    told = "setting scheme = 'faces' is no longer there, 'centroid' is taken for it"
    with pytest.warns(SettingsWarning, match=f"^{told}$"):
        assert make_settings(Knobs, {"scheme": "faces"}) == Knobs()


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"resolutoin": 3}, "unknown setting 'resolutoin'. Did you mean 'resolution'?"),
        ({"resolution": "3.5"}, "setting resolution = '3.5' is not a whole number"),
        ({"resolution": True}, "setting resolution = True is not a whole number"),
        ({"resolution": "inf"}, "setting resolution = 'inf' is not a whole number"),
        ({"resolution": 1}, "setting resolution = 1 is out of range. It goes from 2 to 256."),
        ({"gain": "loud"}, "setting gain = 'loud' is not a number"),
        ({"gain": "nan"}, "setting gain = 'nan' is out of range. It goes from 0.0 to inf."),
        ({"gain": [1]}, "setting gain = [1] is not a number"),
        ({"gain": True}, "setting gain = True is not a number"),
        ({"scheme": "papr"}, "setting scheme = 'papr' is unknown. Choose from centroid, paper."),
        ({"scheme": 3}, "setting scheme = 3 is not text"),
        ({"is_clamped": "perhaps"}, "setting is_clamped = 'perhaps' is not true or false"),
        ({"centre": "1,b"}, "setting centre = '1,b' is not numbers"),
    ],
)
def test_mistakes_get_one_exact_message(values, expected):
    with pytest.raises(SettingsError) as caught:
        make_settings(Knobs, values)
    assert str(caught.value) == expected


def test_the_message_says_where():
    with pytest.raises(SettingsError, match=r"^room\.toml: unknown setting 'x'"):
        make_settings(Knobs, {"x": 1}, where="room.toml")


def test_a_name_that_is_no_text_is_unknown():
    with pytest.raises(SettingsError, match="unknown setting '3'"):
        make_settings(Knobs, {3: 4})
