"""Files of others, tried one after the other in a child process that may be slow or end."""

from __future__ import annotations

import hashlib
import json
import os
import select
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

LIST = Path(__file__).with_name("list.tsv")
MODELS = (
    *(".glb", ".gltf", ".obj", ".ply", ".stl", ".xml"),
    *(".usd", ".usda", ".usdc", ".usdz"),
    *(".vti", ".nc", ".nc4", ".vdb", ".nvdb", ".vol"),
)
LIMIT_S = 90.0
WORDS = 100
"""Letters of a refusal that the list keeps."""


@dataclass(frozen=True)
class Row:
    """A file of a repository: its Git blob's checksum, and what came of it.

    `outcome`: image, refused (with `words`), empty (nothing in it can be seen), blank (an image of
    one colour), find (an error that is none of ours), slow, crash.
    """

    repository: str
    path: str
    blob: str
    outcome: str
    words: str = ""

    @property
    def place(self) -> str:
        """Where it lies below the folder."""
        return f"{self.repository.replace('/', '+')}/{self.path}"


def read_rows(path: Path = LIST) -> list[Row]:
    """The list."""
    lines = path.read_text(encoding="utf-8").splitlines()[1:]
    return [Row(*line.split("\t")) for line in lines]


def write_rows(rows: Iterable[Row], path: Path = LIST) -> None:
    """Replace the list, in the order of its places."""
    ordered = sorted(rows, key=lambda row: (row.repository, row.path))
    lines = ["repository\tpath\tblob\toutcome\twords"]
    for row in ordered:
        lines.append("\t".join((row.repository, row.path, row.blob, row.outcome, row.words)))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def blob_of(path: Path) -> str:
    """The checksum by which Git knows a file's content."""
    data = path.read_bytes()
    return hashlib.sha1(b"blob %d\0" % len(data) + data, usedforsecurity=False).hexdigest()


def models(folder: Path) -> list[tuple[str, Path]]:
    """(repository, file) of all models below a folder of clones named OWNER+NAME."""
    found = []
    for clone in sorted(path for path in folder.iterdir() if "+" in path.name and path.is_dir()):
        files = sorted(path for path in clone.rglob("*") if path.suffix.lower() in MODELS)
        found += [(clone.name.replace("+", "/", 1), path) for path in files]
    return found


def tried(folder: Path, files: list[tuple[str, Path]], command: list[str]) -> Iterator[Row]:
    """What comes of each file; `command` answers paths with lines of JSON."""
    child: subprocess.Popen[str] | None = None
    before = ""
    for repository, path in files:
        clone = folder / repository.replace("/", "+")
        if child is None or before != repository:
            _end(child)
            child, before = _started(command, clone), repository
        answer = _asked(child, path)
        if answer["outcome"] in ("slow", "crash"):
            _end(child)
            child = None
        yield Row(
            repository,
            path.relative_to(clone).as_posix(),
            blob_of(path),
            str(answer["outcome"]),
            short(str(answer["words"]), folder),
        )
    _end(child)


def short(words: str, folder: Path) -> str:
    """What a refusal says, without the file's place: up to WORDS letters of one line."""
    line = " ".join(words.replace(str(folder), "").split())
    head, sep, tail = line.partition(": ")
    return (tail if sep and "/" in head else line)[:WORDS].strip()


def command() -> list[str]:
    """What tries files here."""
    return [sys.executable, str(Path(__file__).with_name("child.py"))]


def _started(command: list[str], clone: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "AIRLIGHT_ROOT": str(clone)},
    )


def _asked(child: subprocess.Popen[str], path: Path) -> dict[str, Any]:
    assert child.stdin is not None and child.stdout is not None
    try:
        child.stdin.write(f"{path}\n")
        child.stdin.flush()
    except BrokenPipeError:
        return {"outcome": "crash", "words": ""}
    ready, _, _ = select.select([child.stdout], [], [], LIMIT_S)
    line = child.stdout.readline() if ready else ""
    if not line:
        return {"outcome": "crash" if ready else "slow", "words": ""}
    answer: dict[str, Any] = json.loads(line)
    return answer


def _end(child: subprocess.Popen[str] | None) -> None:
    if child is not None:
        child.kill()
        child.communicate()
