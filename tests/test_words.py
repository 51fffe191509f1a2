"""One term per thing, the field's own: words that were replaced do not come back.

The test reads names, docstrings, comments, messages and docs alike. A word that is right somewhere
(a picture on a wall, a key of a file that programs read) is allowed there by name.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[1]
READ = ("src/**/*.py", "src/**/*.wgsl", "tests/**/*.py", "docs/**/*.md", "*.md", "examples/*.py")

INSTEAD = {
    "pictures?": "image; frame where it is one of many",
    "software (driver|adapter)s?": "CPU adapter",
    "suns": "directional lights",
    "(suns (and|or) lamps?|lamps (and|or) suns?)": "directional, local lights",
    "similar (even |isotropic )?(air|medi(um|a))": "reduced medium (similarity theory)",
    "even (air|medi(um|a))": "homogeneous medium",
    "(far|faced|endless) air": "analytic half-space medium, volume blockers, endless medium",
    "dimmed": "attenuated",
    "near surroundings": "near field (screen-space occlusion and near-field radiance)",
    "lit runs?": "lit interval",
    "dead ends?": "enclosed faces",
    "(bent|bends) (space|place|surface place|axis)": "wall-aligned lattice warp",
    "openness": "face visibility",
    "anew": "redrawn, recomputed, again",
    "by turns": "interleaved",
    "take home": "export",
    "lets? through": "transmittance, visibility",
    "bounced light": "indirect light; one bounce, all bounces",
    "carried parameters?": "flat interpolants",
    "light that bends once": "single forward deflection",
    "seen triangles?": "visibility buffer, triangle ids",
    "given light": "inter-medium irradiance",
    "take it with you": "exports",
    "look around": "viewer",
    "when it does not work": "troubleshooting",
    "(ways of light|(lights|lobes) ways?)": "path; distance or direction, whichever is meant",
    "even sk(y|ies)": "uniform sky",
    "scatters? (un)?evenly": "scatters isotropically, anisotropically",
    "glow of an ordinate": "angular blur of an ordinate",
    "steady fields?": "converged",
    "bent (cells?|coordinates)": "warped",
    "what is left(?! to)": "the rest, the remainder; what exactly remains",
    "(that |what )?stands? still": "static",
    "lamps?(?! resolution)": "local light; point light, spot, area light",
}
"""A word or two as they are said in prose or joined in a name, and what to write instead."""

ALLOWED = {
    "pictures?": {
        "src/airlight/app/info.py": "a value of --json",
        "src/airlight/figures/registry.py": "a key of figures' JSON",
        "src/airlight/scene/builtin/room.py": "a picture on the wall",
        "src/airlight/scene/builtin/furniture.py": "its frame",
        "tests/scene/builtin": "both",
    },
    "openness": {
        "src/airlight/exports": "an array of light field files",
        "src/airlight/figures": "reads that array",
        "tests/exports": "reads that array",
        "tests/figures": "reads that array",
        "docs/exports.md": "names that array",
        "docs/python.md": "names that array",
    },
    "lamps?(?! resolution)": {
        "src/airlight/scene": "a thing in a room, and what warnings call the light hung there",
        "src/airlight/figures": "captions",
        "tests": "things in rooms",
        "docs": "things in rooms",
        "CHANGELOG.md": "things in rooms",
        "README.md": "things in rooms",
    },
    "suns": {
        "src/airlight/scene": "bright spots of environment maps, several in one",
        "src/airlight/app/info.py": "the module of those",
        "src/airlight/lighting": "those",
        "src/airlight/surface/sky.py": "those",
        "tests/scene/test_map_suns.py": "those",
        "docs": "those",
        "CHANGELOG.md": "those",
    },
    "dead ends?": {
        "src/airlight/exports": "an array of light field files",
        "tests/exports": "reads that array",
        "docs/exports.md": "names that array",
        "docs/python.md": "names that array",
    },
}
"""Where a word stays, by the folder or the file, and why."""

IN_NAMES = {
    "lamps?(?! resolution)": "local light, or light",
    "grain": "noise",
}
"""Words of prose that are no names of functions, classes, arguments and variables."""
NAMES_ALLOWED = {
    "src/airlight/scene": "lamps are things in rooms there, and grain is in textures of stone",
    "tests/scene/builtin": "the same",
}


def words_of(text: str) -> str:
    """Text in lower case, names split into their words: SeenTriangles, seen_triangles."""
    split = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", text)
    return re.sub(r"[_\s]+", " ", split).lower()


@cache
def whole_words(patterns: tuple[str, ...]) -> re.Pattern[str]:
    """What finds any of these patterns as words of their own."""
    return re.compile(f"(?<![a-z])(?:{'|'.join(patterns)})(?![a-z])")


def found_in(plain: str, patterns: Iterable[str] = tuple(INSTEAD)) -> Iterator[tuple[str, str]]:
    """(pattern, what it matched) of each of the replaced words in what `words_of` gives."""
    # Nearly all texts have none of them, which one search says.
    if whole_words(tuple(patterns)).search(plain):
        for pattern in patterns:
            for match in whole_words((pattern,)).finditer(plain):
                yield pattern, match[0]


def names_in(tree: ast.AST) -> Iterator[str]:
    """What a module names: functions, classes, arguments, variables and attributes it sets."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.arg):
            yield node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr


def replaced_names(text: str) -> set[str]:
    """Those names of a module in which a word of `IN_NAMES` stands."""
    words = whole_words(tuple(IN_NAMES))
    return {name for name in names_in(ast.parse(text)) if words.search(words_of(name))}


def is_allowed(pattern: str, name: str) -> bool:
    return any(name == place or name.startswith(place + "/") for place in ALLOWED.get(pattern, ()))


def files() -> list[Path]:
    own = {Path(__file__).resolve()}
    return sorted({path for glob in READ for path in REPOSITORY.glob(glob)} - own)


@pytest.fixture(scope="module")
def words() -> dict[Path, str]:
    """What `words_of` gives of each file that is read."""
    return {path: words_of(path.read_text(encoding="utf-8")) for path in files()}


def test_replaced_words_do_not_come_back(words):
    found: dict[str, int] = {}
    for path, plain in words.items():
        name = path.relative_to(REPOSITORY).as_posix()
        patterns = tuple(pattern for pattern in INSTEAD if not is_allowed(pattern, name))
        for text in (plain, words_of(path.stem)):
            for pattern, word in found_in(text, patterns):
                line = f"{name}: '{word}'; write: {INSTEAD[pattern]}"
                found[line] = found.get(line, 0) + 1
    assert not found, "\n".join(f"{line} ({count} times)" for line, count in found.items())


def test_what_is_allowed_is_there(words):
    """A use that is gone needs no permission."""
    names = {path: path.relative_to(REPOSITORY).as_posix() for path in words}
    for pattern, places in ALLOWED.items():
        for place in places:
            inside = [p for p, name in names.items() if f"{name}/".startswith(f"{place}/")]
            assert any(whole_words((pattern,)).search(words[path]) for path in inside), (
                f"'{pattern}' is not used in {place}"
            )


@pytest.mark.parametrize(
    "text",
    ["SeenTriangles", "a picture\n    of it", "has_suns", "even\nair", "drawn anew", "dead_ends"],
)
def test_the_check_catches_what_it_forbids(text):
    assert list(found_in(words_of(text)))


@pytest.mark.parametrize("text", ["pictured", "evening air", "sunset", "a fair", "renewed"])
def test_the_check_passes_other_words(text):
    assert not list(found_in(words_of(text)))


def test_names_are_the_fields_own(words):
    # A file without the words has no such names, and need not be parsed.
    used = whole_words(tuple(re.sub(r"\(\?!.*?\)", "", pattern) for pattern in IN_NAMES))
    found = [
        f"{name}: {word}"
        for path, plain in words.items()
        if path.suffix == ".py" and used.search(plain)
        for name in [path.relative_to(REPOSITORY).as_posix()]
        if not any(name.startswith(place) for place in NAMES_ALLOWED)
        for word in sorted(replaced_names(path.read_text(encoding="utf-8")))
    ]
    assert not found, "\n".join(found)


def test_replaced_names_are_found():
    text = "def test_a_lamp(LAMPS, clamp):\n    self.grain = x\n    lamp_resolution = 'lamp'\n"
    assert replaced_names(text) == {"test_a_lamp", "LAMPS", "grain"}
