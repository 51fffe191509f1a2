"""`airlight export-lattice`: a folder of arrays, and plain refusals before any work."""

from __future__ import annotations

import json

import pytest

from airlight.app import cli
from airlight.app.export_lattice import command


def test_a_folder_of_arrays_with_a_header(gpu, tmp_path, capsys):
    words = [
        "export-lattice",
        "builtin:cornell",
        "-o",
        str(tmp_path / "light"),
        "-t",
        "lpv",
        "-D",
        "resolution=8",
        "-D",
        "surfels=2000",
    ]
    assert cli.run(words) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'light'}\n"
    header = json.loads((tmp_path / "light" / "header.json").read_text())
    assert header["technique"] == "lpv"
    written = {path.stem for path in (tmp_path / "light").glob("*.npy")}
    assert written == set(header["arrays"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["-o", "{in}/light.obj"],
            "cannot write a light field that ends in '.obj'. "
            "End its name in .npz or .vdb, or name a folder.",
        ),
        (["-o", "{in}/file"], "this is a file, not a folder"),
        (["-o", "{in}/nowhere/light.npz"], "does not exist"),
        (["-o", "{in}/light.npz", "-t", "direct"], "technique 'direct' keeps no light"),
        (["-o", "{in}/light.npz", "-t", "lpw"], "unknown technique 'lpw'. Did you mean 'lpv'?"),
    ],
)
def test_what_cannot_be_is_one_message(tmp_path, capsys, words, message):
    (tmp_path / "file").write_text("")
    chosen = [word.replace("{in}", str(tmp_path)) for word in words]
    assert cli.run(["export-lattice", "builtin:cornell", *chosen]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file"]


def test_its_help_names_the_formats():
    (output,) = (option for option in command.params if option.name == "output")
    assert "header.json" in output.help
