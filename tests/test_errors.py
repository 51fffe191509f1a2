"""Errors: one line that says where, what and what to do."""

from __future__ import annotations

import pytest

from airlight import errors
from airlight.errors import AirlightError, SceneError, nearest


@pytest.mark.parametrize(
    ("where", "remedy", "expected"),
    [
        ("", "", "bad"),
        ("a.toml", "", "a.toml: bad"),
        ("", "Do this.", "bad. Do this."),
        ("a.toml", "Do this.", "a.toml: bad. Do this."),
    ],
)
def test_the_message_is_complete(where, remedy, expected):
    error = SceneError("bad", where=where, remedy=remedy)
    assert str(error) == expected
    assert (error.where, error.problem, error.remedy) == (where, "bad", remedy)


def test_everything_a_user_sees_is_one_family():
    family = {
        errors.SceneError,
        errors.SettingsError,
        errors.DeviceError,
        errors.ShaderError,
        errors.OutputError,
        errors.ReferenceFailure,
    }
    assert all(issubclass(kind, AirlightError) for kind in family)


def test_nearest_names_one_and_else_all():
    assert nearest("sigma", ["sigma_t", "albedo"]) == "Did you mean 'sigma_t'?"
    assert nearest("zzz", ["b", "a"]) == "Known: a, b."
    assert nearest("zzz", []) == ""
