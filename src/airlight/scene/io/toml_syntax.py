"""Tables, numbers, texts and arrays as TOML: what the standard library reads and does not write."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np


def toml_lines(table: Mapping[str, Any], path: tuple[str, ...] = ()) -> Iterator[str]:
    """The lines of `table`: its own keys first, then the tables in it, each under its header.

    `path`: the names of the tables it lies in. Keys whose value is None are left out.
    """
    inner = {k: v for k, v in table.items() if isinstance(v, Mapping) or _is_tables(v)}
    # A table's own keys have to come before the header of any table in it.
    for key, value in table.items():
        if key not in inner and value is not None:
            yield f"{_key(key)} = {_value(value)}"
    for key, value in inner.items():
        name = ".".join(_key(part) for part in (*path, key))
        for one in [value] if isinstance(value, Mapping) else value:
            # A table of nothing but tables needs no header of its own.
            has_own = any(not isinstance(v, Mapping) for v in one.values())
            if has_own or not isinstance(value, Mapping):
                yield f"\n[{name}]" if isinstance(value, Mapping) else f"\n[[{name}]]"
            yield from toml_lines(one, (*path, key))


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _key(key: str) -> str:
    is_bare = key.isascii() and key.replace("-", "").replace("_", "").isalnum()
    return key if is_bare else _value(key)


def _value(value: Any) -> str:
    # Booleans before numbers, as they are integers in Python.
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)
