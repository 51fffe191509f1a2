"""The map from the papers to the code names what is there, and the code cites the papers."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
SOURCE = REPOSITORY / "src" / "airlight"
PAGE = (REPOSITORY / "docs" / "architecture.md").read_text(encoding="utf-8")


def rows(heading: str) -> list[list[str]]:
    """Cells of the first table under a heading."""
    _, _, rest = PAGE.partition(f"## {heading}\n")
    section = rest.partition("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")][2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


PAPERS = rows("From the papers to the code")


def test_ten_equations_and_three_papers():
    keys = [row[0].split()[0] for row in PAPERS]
    assert len(keys) >= 10
    assert set(keys) == {"Kaplanyan2010", "Billeter2012", "Elek2014"}


@pytest.mark.parametrize("row", PAPERS, ids=lambda row: row[0].partition(":")[0])
def test_the_truth_exists_and_cites(row):
    for name in re.findall(r"`([\w.]+)`", row[1]):
        module, _, function = name.rpartition(".")
        found = importlib.import_module(f"airlight.{module}")
        assert callable(getattr(found, function)), name
        if module != "reference.quadrature":  # knows no technique: the light itself
            assert row[0].split()[0] in Path(found.__file__).read_text(encoding="utf-8")


@pytest.mark.parametrize("row", PAPERS, ids=lambda row: row[0].partition(":")[0])
def test_the_line_on_the_device_exists_and_cites(row):
    named = re.findall(r"`([\w/]+\.(?:wgsl|py))`: ((?:`\w+`(?:, )?)+)", row[2])
    assert named or row[2] == "on the host"
    for path, functions in named:
        text = (SOURCE / path).read_text(encoding="utf-8")
        assert row[0].split()[0] in text, f"{path} does not cite {row[0].split()[0]}"
        for function in re.findall(r"`(\w+)`", functions):
            assert re.search(rf"\b(fn|def) {function}\(", text), f"{path}: {function}"


def test_the_calls_from_the_command_to_the_stencil_exist():
    calls = [
        re.fullmatch(r"`([\w.]+)`", row[0])[1] for row in rows("From the command to the stencil")
    ]
    assert 8 <= len(calls) <= 12
    for name in calls:
        parts = name.split(".")
        for cut in range(len(parts), 0, -1):
            path = SOURCE.joinpath(*parts[:cut]).with_suffix(".py")
            if path.exists():
                found = importlib.import_module("airlight." + ".".join(parts[:cut]))
                for part in parts[cut:]:
                    found = getattr(found, part)
                assert found is not None
                break
        else:
            raise AssertionError(name)


def misplaced(page: str) -> set[str]:
    """Files and dotted names in backquotes that are not there: `gpu/slots.py`, `fields.Solver`.

    A path may begin at the repository, the package, or, of a shader, in `wgsl/`.
    """
    wrong = set()
    for name in set(re.findall(r"`([\w./]+)`", page)):
        if "/" in name and not re.search(r"NAME|^airlight/|[.]/", name):
            ends = [name, f"{name}.py", f"{name}.wgsl", f"wgsl/{name}.wgsl"]
            if not any((top / end).exists() for top in (REPOSITORY, SOURCE) for end in ends):
                wrong.add(name)
        first, *rest = name.split(".")
        if first and rest and (SOURCE / first).is_dir() and not is_there([first, *rest]):
            wrong.add(name)
    return wrong


def is_there(parts: list[str]) -> bool:
    """Whether a dotted name is a module, or a module's text has the rest of it as words."""
    for cut in range(len(parts), 0, -1):
        base = SOURCE.joinpath(*parts[:cut])
        path = base.with_suffix(".py") if base.with_suffix(".py").exists() else base / "__init__.py"
        if path.exists():
            text = path.read_text(encoding="utf-8")
            return all(re.search(rf"\b{word}\b", text) for word in parts[cut:])
    return False


def test_what_the_map_names_is_there():
    assert not misplaced(PAGE)


def test_what_is_not_there_is_found():
    page = (
        "`gpu/slots.py` `fields.Solver` `media.media` `media.gone` `lpv/gone.wgsl` "
        "`scene.gone.at` `gpu.gone`"
    )
    assert misplaced(page) == {"media.gone", "lpv/gone.wgsl", "scene.gone.at", "gpu.gone"}
