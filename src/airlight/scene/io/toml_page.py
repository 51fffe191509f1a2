"""The scene-file reference page, printed from the loader's own tables."""

from __future__ import annotations

from ..keys import Key
from .toml_keys import KEYS
from .toml_tables import TABLES


def schema_markdown() -> str:
    """The scene-file reference page: one section per table, one row per key."""
    parts = [_PREAMBLE]
    for table in (*TABLES, *KEYS.values()):
        parts.append(f"## `{table.header}`\n\n{table.doc}\n\n{_rows(table.keys)}")
        for name, keys in (table.variants or {}).items():
            parts.append(f'With `{table.variant_key} = "{name}"`:\n\n{_rows(keys)}')
    parts.append(_TECHNIQUE)
    return "\n\n".join(parts) + "\n"


def _rows(keys: tuple[Key, ...]) -> str:
    lines = ["| key | value | unit | default | meaning |", "|---|---|---|---|---|"]
    for key in keys:
        default = "**required**" if key.required else key.default
        cells = (f"`{key.name}`", key.kind.words, key.unit, default, key.doc)
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


_PREAMBLE = """\
# Scene file, version 1

A TOML file. Every key is checked; an unknown one is refused with the nearest known name. Paths \
are relative to the scene file. Vectors are arrays of three numbers, a colour is three linear \
Rec.709 numbers or one for grey. Right-handed, +Y up, metres. Directions are those \
of travel: away from the light.

Which files a scene file, or any other file of a scene, may name is \
[one rule](files.md#files-that-name-others). A file that claims to unpack to \
far more than its size bears out is refused.

Numbers are at most 1e15, positions and sizes 1e9 m, and a scene reaches at most 1e8 m from the \
origin: beyond, single precision has no image of it.

This page is printed from the loader's own table by `./run docs`."""

_TECHNIQUE = """\
## `[technique.NAME]`

Settings of the technique NAME, the same names as `-D key=value` and the Python fields."""
