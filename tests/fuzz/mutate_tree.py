"""Damage to documents: values of other kinds and sizes, keys, nesting, paths, arrays.

A document is what TOML and JSON parsers give: dictionaries, lists, texts, numbers, booleans.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any

from .mutate_bytes import FLOATS, NUMBERS

Path = tuple[Any, ...]

TEXTS = (
    "",
    " ",
    "a",
    "\0",
    "a\nb",
    "\x1b[2J",
    "a\tb",
    "\u202egnp.a",
    "\ufeff",
    "\ud800",
    "é" * 130,
    "n" * 260,
    "x" * 5000,
    "%s%n",
    "{}",
    "$x",
    "nan",
    "1e400",
    "-1",
    "true",
    "null",
    "None",
    "__proto__",
    "../" * 40,
)
PATHS = (
    ".",
    "..",
    "/",
    "//",
    "/dev/zero",
    "/dev/stdin",
    "/proc/self/mem",
    "/etc/passwd",
    "fifo",
    "link",
    "loop",
    "folder",
    "missing.obj",
    "../outside/secret.png",
    "../outside/secret.ply",
    "..%2foutside%2fsecret.png",
    "%2e%2e/outside/secret.png",
    "..\\outside\\secret.png",
    "file:///etc/passwd",
    "http://localhost/a.png",
    "data:,",
    "data:;base64,",
    "data:;base64,AA==",
    "data:image/png;base64,!!!",
    "~",
    "~nosuchuser/x",
    "~/x",
    "con",
    "a\0b.png",
    "a" * 260 + ".png",
    "*",
    "**/*",
    "?" * 60,
    "[",
    "frame_*.npy",
    "a" * 5000,
    "builtin:atrium",
    "-",
)
HUGE = (10**400, 10**4000)


@dataclass(frozen=True)
class Words:
    """What a format knows: names of keys, and texts that mean something as values."""

    keys: Sequence[str] = ()
    values: Sequence[str] = ()


def damaged(document: Any, random: Random, words: Words) -> Any:
    """The document itself, after one to five damages."""
    for _ in range(random.choice((1, 1, 1, 2, 2, 3, 5))):
        if places := walk(document):
            _once(document, random.choice(places), random, words)
    return document


def walk(document: Any) -> list[Path]:
    """The paths of all values in a document but its own; of long lists those of 40 elements."""
    found: list[Path] = []
    left: list[tuple[Any, Path]] = [(document, ())]
    while left:
        value, at = left.pop()
        is_table = isinstance(value, dict)
        inner = value.items() if is_table else enumerate(value[:40])
        for key, held in inner:
            path = (*at, key)
            found.append(path)
            if isinstance(held, (dict, list)):
                left.append((held, path))
    return found


def held_at(document: Any, path: Path) -> Any:
    """The value at a path."""
    for key in path:
        document = document[key]
    return document


def _once(document: Any, path: Path, random: Random, words: Words) -> None:
    parent, key = held_at(document, path[:-1]), path[-1]
    old = parent[key]
    roll = random.random()
    if roll < 0.55:
        parent[key] = _other(old, document, random, words)
    elif roll < 0.70:
        del parent[key]
    elif roll < 0.85 and isinstance(parent, dict):
        _change_keys(parent, key, document, random, words)
    elif isinstance(parent, list):
        _change_list(parent, key, random)
    else:
        parent[key] = _somewhere(document, random)


def _other(old: Any, document: Any, random: Random, words: Words) -> Any:
    """Another value in the place of `old`, of its own kind or not."""
    if random.random() < 0.2:
        return _any(document, random, words)
    if isinstance(old, bool):
        return random.choice((not old, int(old), str(old), None, []))
    if isinstance(old, (int, float)):
        return _number(old, random)
    if isinstance(old, str):
        return _text(old, random, words)
    return _container(old, document, random, words)


def _number(old: float, random: Random) -> Any:
    if abs(old) > 1e300:
        return random.choice(NUMBERS)
    small = random.choice((old + 1, old - 1, -old, old * 2, old * 1000, old / 3, old * 1e-6))
    return random.choice(
        (
            small,
            small,
            random.choice(NUMBERS),
            random.choice(NUMBERS),
            random.choice(FLOATS),
            random.choice((1, -1)) * random.choice(HUGE),
            random.uniform(-10, 10),
            random.randint(-5, 300),
            str(old),
            [old],
        )
    )


def _text(old: str, random: Random, words: Words) -> Any:
    known = random.choice(words.values) if words.values else "x"
    at = random.randint(0, len(old))
    return random.choice(
        (
            known,
            known,
            random.choice(TEXTS),
            random.choice(PATHS),
            random.choice(PATHS),
            old[:at],
            old[:at] + random.choice(TEXTS) + old[at:],
            old * 40,
            old.upper(),
            [old],
        )
    )


def _container(old: Any, document: Any, random: Random, words: Words) -> Any:
    if isinstance(old, dict):
        name = random.choice(words.keys) if words.keys else "x"
        return random.choice(
            ({}, [old], [old] * 3, {**old, name: _any(document, random, words)}, list(old), None)
        )
    if isinstance(old, list):
        return random.choice(
            (
                [],
                old[:-1],
                old[1:],
                old + old,
                old[::-1],
                old[:1] * 300,
                [old],
                [[]] * 3,
                dict(enumerate_keys(old)),
                old[0] if old else 0,
            )
        )
    return _any(document, random, words)


def enumerate_keys(values: list[Any]) -> list[tuple[str, Any]]:
    """A list's elements under the texts of their numbers."""
    return [(str(k), value) for k, value in enumerate(values)]


def _any(document: Any, random: Random, words: Words) -> Any:
    make: Callable[[], Any] = random.choice(
        (
            lambda: random.choice(NUMBERS),
            lambda: random.choice(FLOATS),
            lambda: random.choice((True, False, None)),
            lambda: random.choice(TEXTS),
            lambda: random.choice(PATHS),
            lambda: random.choice(words.values or TEXTS),
            lambda: [random.choice(FLOATS) for _ in range(random.choice((0, 1, 2, 3, 4, 16)))],
            lambda: _deep(random.choice((20, 100, 400))),
            lambda: _somewhere(document, random),
            dict,
            list,
        )
    )
    return make()


def _deep(levels: int) -> Any:
    value: Any = 1
    for level in range(levels):
        value = [value] if level % 2 else {"a": value}
    return value


def _somewhere(document: Any, random: Random) -> Any:
    """A copy of what stands elsewhere in the document."""
    return copy.deepcopy(held_at(document, random.choice(walk(document) or [()])))


def _change_keys(table: dict[str, Any], key: str, document: Any, random: Random, words: Words):
    """A key gets another name, a known one joins it, or two swap their values."""
    name = random.choice(words.keys) if words.keys else "x"
    roll = random.random()
    if roll < 0.35:
        table[random.choice((name, key[:-1], key + "x", random.choice(TEXTS)))] = table.pop(key)
    elif roll < 0.75:
        table[name] = _any(document, random, words)
    else:
        other = random.choice(list(table))
        table[key], table[other] = table[other], table[key]


def _change_list(values: list[Any], index: int, random: Random) -> None:
    """An element stands twice, a hundred times, or elsewhere."""
    value = values[index]
    times = random.choice((1, 1, 2, 100))
    at = random.randint(0, len(values))
    values[at:at] = [copy.deepcopy(value) for _ in range(times)]
