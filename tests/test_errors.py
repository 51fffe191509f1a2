"""Errors: one line that says where, what and what to do."""

from __future__ import annotations

import numpy as np
import pytest

from airlight import errors
from airlight.errors import AirlightError, SceneError, memory_wanted, nearest, within_memory
from airlight.scene import Scene


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


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("two\nlines", "two\\nlines"),
        ("\x1b[2J", "\\x1b[2J"),
        ("\u202egnp.a", "\\u202egnp.a"),
        ("\ud800", "\\ud800"),
        ("Grün 道", "Grün 道"),
    ],
)
def test_what_cannot_be_printed_is_escaped(name, shown):
    error = SceneError(f"it names '{name}'", where=name, remedy="Mend it.")
    assert str(error) == f"{shown}: it names '{shown}'. Mend it."
    assert error.problem == f"it names '{name}'"
    assert Scene(warnings=(f"{name} is left out",)).warnings == (f"{shown} is left out",)


def test_a_message_has_an_end():
    text = str(SceneError("9" * 10**6 + " is no number", where="a.xml", remedy="Mend it."))
    assert len(text) < 2000
    assert text.startswith("a.xml: 999") and text.endswith("99 is no number. Mend it.")


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


def test_memory_that_runs_out_is_said_with_its_size():
    with (
        pytest.raises(SceneError, match=r"^a\.npy: the grid does not fit into memory \(\d.* EiB "),
        within_memory("the grid", where="a.npy", kind=SceneError),
    ):
        np.empty((1 << 40, 1 << 19))
    with (
        pytest.raises(AirlightError, match=r"^the grid does not fit into memory\. Halve it\.$"),
        within_memory("the grid", remedy="Halve it."),
    ):
        raise MemoryError


def test_whole_units_are_written_without_a_point():
    error = MemoryError("Unable to allocate 256. MiB for an array with shape (8,) and ...")
    assert memory_wanted(error) == " (256 MiB were wanted at once)"
