"""Every example on every page is run, as a reader would: files saved, commands typed, code run.

A page's blocks share one folder and one Python namespace, top to bottom. Notes before a block:
`<!-- file: NAME -->` saves it; `<!-- adds to A as B -->` saves a copy of A with it in front of its
environment; `<!-- not run -->` leaves it out.
"""

from __future__ import annotations

import importlib.util
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from airlight.app import cli

REPOSITORY = Path(__file__).parents[2]
PAGES = [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
QUICK = ("techniques/index.md",)
"""Pages run every time; the others with --slow."""
NOT_RUN = ("./run", ".ci/run", "pip", "ssh", "sudo", "python", ".venv/bin/python", "pytest")
"""Words that begin a line which is not airlight's, or is a test of its own elsewhere."""
SLOW_COMMANDS = ("view", "bench", "compare", "sequence", "turntable", "figure --all")
"""Tested elsewhere: they need a screen, a path tracer, or minutes."""
NEEDS = {".nc": "xarray", "--denoise": "pyoidn"}
"""Ends of words that need an extra, and a module of it; without it such lines are not run."""
_BLOCK = re.compile(
    r"(?:<!-- (?P<note>[^>]*?) -->\n)?```(?P<language>\w+)\n(?P<text>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)


@dataclass(frozen=True)
class Block:
    """One fenced example and the note before it."""

    language: str
    text: str
    note: str


def blocks(page: Path) -> list[Block]:
    found = _BLOCK.finditer(page.read_text(encoding="utf-8"))
    return [Block(m["language"], m["text"], m["note"] or "") for m in found]


def name_of(page: Path) -> str:
    return page.relative_to(REPOSITORY).as_posix().removeprefix("docs/")


RUN = ("python", "sh", "toml")
BOX = """<scene version="3.0.0"><shape type="cube"/><emitter type="constant"/>
<sensor type="perspective"><transform name="to_world">
<lookat origin="0,1,4" target="0,1,0" up="0,1,0"/></transform></sensor></scene>"""
PRINTED = ("scene-file.md", "command-line.md", "python.md")
WITH_EXAMPLES = [
    page
    for page in PAGES
    if page.name not in PRINTED and any(block.language in RUN for block in blocks(page))
]


def _parameter(page: Path) -> object:
    name = name_of(page)
    return pytest.param(page, id=name, marks=() if name in QUICK else pytest.mark.slow)


@pytest.mark.parametrize("page", [_parameter(page) for page in WITH_EXAMPLES])
def test_what_a_page_shows_works(gpu, page, small, model, capsys):
    model("my.obj")
    (small / "cbox.xml").write_text(BOX)
    np.save(small / "smoke.npy", np.ones((4, 5, 6), np.float32))
    save_cloud(small / "cloud.nc")
    namespace: dict[str, object] = {}
    for block in blocks(page):
        if block.note.startswith("not run"):
            continue
        if block.language == "toml":
            save(block, small)
        elif block.language == "python":
            exec(compile(block.text, f"{page.name}: python", "exec"), namespace)
        elif block.language == "sh":
            type_in(block.text, capsys)


def save(block: Block, folder: Path) -> None:
    """The file that a note says a block is; others are only looked at."""
    if block.note.startswith("file: "):
        (folder / block.note.removeprefix("file: ")).write_text(block.text)
    elif block.note.startswith("adds to "):
        source, target = block.note.removeprefix("adds to ").split(" as ")
        text = (folder / source).read_text()
        before, head, after = text.partition("[environment]")
        (folder / target).write_text(f"{before}{block.text}\n{head}{after}")


def save_cloud(path: Path) -> None:
    """A NetCDF 3 file as a cloud model writes one, where xarray is there to read it."""
    if not importlib.util.find_spec("xarray"):
        return
    import xarray

    water = np.full((3, 4, 5), 1e-4)
    coords = {name: np.arange(n) * 100.0 for name, n in zip("zyx", water.shape, strict=True)}
    data = xarray.Dataset({"ql": (("z", "y", "x"), water, {"units": "kg kg-1"})}, coords)
    data.to_netcdf(path, engine="scipy")


def type_in(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    for line in text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if not words or words[0].startswith(NOT_RUN):
            continue
        assert words[0] == "airlight", f"what is this? {line}"
        needed = [module for end, module in NEEDS.items() for w in words if w.endswith(end)]
        if not all(importlib.util.find_spec(module) for module in needed):
            continue
        if any(f"{' '.join(words[1:])} ".startswith(f"{slow} ") for slow in SLOW_COMMANDS):
            continue
        code = cli.run(_quickly(words[1:]))
        said = capsys.readouterr()
        assert code == 0, f"{line}\n{said.err}"


def _quickly(words: list[str]) -> list[str]:
    more = {"render": ["--samples", "1", "-q"], "figure": ["--quick", "-q"]}
    return [*words, *more.get(words[0], [])]


def test_pages_lead_to_pages_that_there_are():
    broken = []
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text("utf-8")):
            if not target.startswith(("http", "mailto:")) and not (page.parent / target).exists():
                broken.append(f"{name_of(page)}: {target}")
    assert not broken, "\n".join(broken)


def test_blocks_of_other_languages_are_known():
    known = {*RUN, "text", "toctree"}
    for page in PAGES:
        assert {block.language for block in blocks(page)} <= known, page.name


def test_the_gallery_has_small_images_of_one_size():
    page = REPOSITORY / "docs" / "gallery.md"
    images = re.findall(r"!\[[^\]]+\]\((images/gallery-[\w-]+\.jpg)\)", page.read_text("utf-8"))
    assert len(images) >= 10
    there = {f"images/{path.name}" for path in (page.parent / "images").glob("gallery-*")}
    assert there == set(images)
    for name in images:
        path = page.parent / name
        assert path.stat().st_size < 100_000, name
        with PIL.Image.open(path) as image:
            assert image.size == (640, 360), name
