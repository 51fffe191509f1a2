"""The fuzzer itself: a few inputs here, a minute of all loaders in the slow tests."""

from __future__ import annotations

import pytest

from fuzz.__main__ import main
from fuzz.finds import Run, explore, told

SEED = 13


@pytest.mark.parametrize("loader", ["toml", "gltf"])
def test_damaged_files_give_a_scene_or_one_message(loader):
    run = Run(loader, SEED)
    explore(run, 40)
    assert run.tried == 40
    assert not run.finds, "\n".join(told(find) for find in run.finds.values())


def test_one_input_is_repeated_by_its_number(capsys):
    assert main(["--loader", "ply", "--seed", "5", "--only", "3"]) == 0
    assert capsys.readouterr().out.endswith("opened by load: a.ply\nit went as it should\n")


@pytest.mark.slow
def test_a_minute_of_damaged_files_for_every_loader(capsys):
    assert main(["--seed", str(SEED), "--minutes", "1"]) == 0, capsys.readouterr().out
