"""The gallery page: every figure drawn is on it, with its numbers; nothing outside it is needed."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser

import numpy as np
import PIL.Image
import pytest

from airlight.app import cli
from airlight.errors import SceneError
from airlight.figures.gallery import PAGE, PAPERS, page, write_gallery
from airlight.figures.registry import FIGURES


def drawn(folder, name, numbers):
    image = np.zeros((9, 16, 3), np.uint8)
    PIL.Image.fromarray(image).save(folder / f"{name}.png")
    told = {"figure": name, "command": f"airlight figure {name} -o x", "numbers": numbers}
    (folder / f"{name}.json").write_text(json.dumps(told))


class Tags(HTMLParser):
    """Every attribute that leads somewhere, and whether tags close as they open."""

    void = ("meta", "img", "br", "link")

    def __init__(self):
        super().__init__()
        self.open, self.links, self.ids = [], [], []

    def handle_starttag(self, tag, attrs):
        if tag not in self.void:
            self.open.append(tag)
        self.links += [value for key, value in attrs if key in ("src", "href")]
        self.ids += [value for key, value in attrs if key == "id"]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_figures_of_the_folder_with_their_numbers(tmp_path):
    numbers = {"energy": {"with <walls>": 0.91234567, "runs": list(range(40))}, "said": None}
    drawn(tmp_path, "clpv-7", numbers)
    drawn(tmp_path, "clpv-debug", {"modes": [{"ms": 1.0}, {"ms": 2.5}]})
    text = write_gallery(tmp_path).read_text("utf-8")
    assert "energy → with &lt;walls&gt;" in text
    assert "<td>0.9123</td>" in text
    assert "10, 11 … (40)" in text
    assert "modes 2 → ms" in text
    assert FIGURES["clpv-7"].shows in text
    assert "airlight figure clpv-7 -o x" in text
    assert text.index("clpv-7") < text.index(PAPERS[""])
    assert "clpv-5 " in text.partition("Not drawn here yet")[2]


def test_it_holds_its_images_and_leads_only_beside_itself(tmp_path):
    drawn(tmp_path, "clpv-7", {"a": 1})
    tags = Tags()
    tags.feed(page(tmp_path))
    assert tags.open == []
    for link in tags.links:
        if link.startswith("#"):
            assert link[1:] in tags.ids
        elif not link.startswith("data:image/jpeg;base64,"):
            assert (tmp_path / link).is_file()


def test_every_figure_has_a_heading_it_comes_under():
    assert {known.source.partition(" ")[0] for known in FIGURES.values()} <= set(PAPERS)


def test_a_broken_file_is_named(tmp_path):
    drawn(tmp_path, "clpv-7", {"a": 1})
    (tmp_path / "clpv-7.json").write_text("{}")
    with pytest.raises(SceneError, match=r"clpv-7.json: not the numbers of a figure. Draw clpv-7"):
        page(tmp_path)


def test_from_the_command_line(tmp_path, capsys):
    words = ["figure", "clpv-5", "--gallery", "-o", str(tmp_path), "--size", "120x120", "-q"]
    assert cli.run(words) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(tmp_path / PAGE)
    assert re.search(r"1 of \d+ figures", (tmp_path / PAGE).read_text("utf-8"))
    (tmp_path / PAGE).unlink()
    assert cli.run(["figure", "--gallery", "-o", str(tmp_path)]) == 0
    assert (tmp_path / PAGE).is_file()
