"""The list of files of others, and what tries them."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from .trial import Row, blob_of, models, read_rows, short, tried, write_rows

OUTCOMES = {"image", "refused", "empty", "blank"}


def test_the_list_says_what_came_of_each_file() -> None:
    rows = read_rows()
    assert len({row.place for row in rows}) == len(rows) > 250
    for row in rows:
        assert re.fullmatch(r"[0-9a-f]{40}", row.blob), row
        assert row.outcome in OUTCOMES, row
        assert (row.outcome == "refused") == bool(row.words), row
    assert rows == sorted(rows, key=lambda row: (row.repository, row.path))


def test_nine_in_ten_load_or_say_why_not() -> None:
    """Files that hold a surface to see; the others are refused in words, as they should be."""
    rows = read_rows()
    told = [row for row in rows if row.outcome in ("image", "refused")]
    assert len(told) >= 0.9 * len(rows)


def test_a_list_comes_back(tmp_path: Path) -> None:
    rows = [
        Row("a/b", "x y.glb", "0" * 40, "image"),
        Row("a/a", "z.obj", "1" * 40, "refused", "no"),
    ]
    write_rows(rows, tmp_path / "list.tsv")
    assert read_rows(tmp_path / "list.tsv") == rows[::-1]


ANSWERS = """
import json, os, sys
for line in sys.stdin:
    name = line.strip().rsplit("/", 1)[-1]
    if name.startswith("crash"):
        sys.exit(3)
    words = f"{line.strip()}: {os.environ['AIRLIGHT_ROOT'][-3:]}" if "bad" in name else ""
    print(json.dumps({"outcome": "refused" if words else "image", "words": words}), flush=True)
"""


def test_each_file_is_tried_and_a_crash_is_one_of_them(tmp_path: Path) -> None:
    for name in ("a+b/bad.obj", "a+b/crash.glb", "a+b/deep/good.ply", "c+d/note.txt", "no/x.obj"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"content")
    files = models(tmp_path)
    assert [name for name, _ in files] == ["a/b"] * 3
    rows = list(tried(tmp_path, files, [sys.executable, "-c", ANSWERS]))
    assert [(row.outcome, row.words) for row in rows] == [
        ("refused", "a+b"),
        ("crash", ""),
        ("image", ""),
    ]
    # git hash-object of a file with the bytes "content"
    assert {row.blob for row in rows} == {"6b584e8ece562ebffc15d38808cd6b98fc3d97ea"}


@pytest.mark.parametrize(
    ("words", "kept"),
    [
        ("/clones/me/a+b/x.obj: it has no triangles", "it has no triangles"),
        ("/clones/me/a+b/x.obj, line 3: 'v 1' is\n  short", "'v 1' is short"),
        ("NaN everywhere", "NaN everywhere"),
    ],
)
def test_words_are_kept_without_places(words: str, kept: str) -> None:
    assert short(words, Path("/clones/me")) == kept


def test_checksums_are_gits(tmp_path: Path) -> None:
    (tmp_path / "empty").write_bytes(b"")
    assert blob_of(tmp_path / "empty") == "e69de29bb2d1d6434b8b29ae775ad8c2e48c5391"
