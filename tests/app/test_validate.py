"""`airlight validate`: good scenes pass, bad ones say why, to people and machines."""

from __future__ import annotations

import json

import numpy as np
import pytest

from airlight.app import cli

BOX = '[[mesh]]\nshape = "box"\nemission = 10\n'


@pytest.fixture
def validate(tmp_path, capsys):
    """(exit code, stdout, stderr) for a scene file's text."""

    def run(text: str, *options: str) -> tuple[int, str, str]:
        (tmp_path / "a.toml").write_text(text)
        code = cli.run(["validate", str(tmp_path / "a.toml"), *options])
        out, err = capsys.readouterr()
        return code, out.replace(f"{tmp_path}/", ""), err.replace(f"{tmp_path}/", "")

    return run


def test_a_good_scene(validate):
    assert validate(BOX) == (0, "a.toml: valid\n", "")
    code, out, _ = validate(BOX, "--json")
    assert code == 0
    assert json.loads(out)["valid"] is True


def test_every_file_of_a_sequence_is_read(validate, tmp_path):
    for k, side in enumerate((4, 4, 5)):
        np.save(tmp_path / f"p{k}.npy", np.ones((4, 4, side), np.float32))
    text = '[[volume]]\nsequence = "p*.npy"\nsigma_t = 1\n'
    expected = "its grid has 4 x 4 x 5 cells, the sequence's first has 4 x 4 x 4. "
    code, _, err = validate(text)
    assert code == 2
    assert err == f"error: p2.npy: {expected}Resample the sequence to one size.\n"
    np.save(tmp_path / "p2.npy", np.ones((4, 4, 4), np.float32))
    assert validate(text)[0] == 0


def test_a_bad_scene(validate):
    expected = "[[mesh]] 1: shape = 'bx' is unknown. Did you mean 'box'?"
    assert validate('[[mesh]]\nshape = "bx"\n') == (2, "", f"error: a.toml: {expected}\n")


def test_a_bad_scene_as_json(validate):
    code, out, err = validate('[[mesh]]\nshape = "bx"\n', "--json")
    told = json.loads(out)
    assert code == 2
    assert err.startswith("error: ")
    assert told == {
        "file": told["file"],
        "valid": False,
        "where": "a.toml",
        "problem": "[[mesh]] 1: shape = 'bx' is unknown",
        "remedy": "Did you mean 'box'?",
    }


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        (
            "[technique.lpw]\n",
            "a.toml: [technique.lpw]: unknown technique 'lpw'. Did you mean 'lpv'?",
        ),
        (
            "[technique.lpv]\nresolutoin = 3\n",
            "a.toml: [technique.lpv]: unknown setting 'resolutoin'. Did you mean 'resolution'?",
        ),
    ],
)
def test_technique_settings_are_checked(validate, table, expected):
    assert validate(BOX + table) == (2, "", f"error: {expected}\n")


def test_good_technique_settings_pass(validate):
    assert validate(BOX + "[technique.lpv]\nresolution = 16\n")[0] == 0


@pytest.mark.parametrize("command", ["info", "validate", "render"])
def test_all_commands_refuse_alike(tmp_path, capsys, command):
    np.save(tmp_path / "huge.npy", np.full((2, 2, 2), 1e30, np.float32))
    (tmp_path / "point.obj").write_text("v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n")
    (tmp_path / "speck.obj").write_text("v 0 0 0\nv 1e-12 0 0\nv 0 1e-12 0\nf 1 2 3\n")
    output = ["-o", str(tmp_path / "a.png")] if command == "render" else []
    said = {
        "huge.npy": "its density holds 1e+30, at most 1e+15 can be used",
        "point.obj": "all that the scene holds lies in one point. Is a scale 0? Give it a size.",
        "speck.obj": "all that the scene holds is 1e-12 m large, at least 1e-09 m can be used. "
        "Make its scale larger.",
    }
    for name, expected in said.items():
        assert cli.run([command, str(tmp_path / name), *output]) == 2
        assert f"{name}: {expected}" in capsys.readouterr().err
