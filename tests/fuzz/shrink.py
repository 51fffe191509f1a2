"""A failing input made smaller, as long as it still fails alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from .targets import Case

TRIES = 300


def shrunk(case: Case, fails: Callable[[Case], bool], tries: int = TRIES) -> Case:
    """The smallest of some cases that `fails` holds for: files left out, then pieces of them."""
    for name in sorted(case.files):
        if name != case.main:
            without = {k: raw for k, raw in case.files.items() if k != name}
            if fails(smaller := replace(case, files=without)):
                case = smaller
    for name in (case.main, *(n for n in sorted(case.files) if n != case.main)):
        case, tries = _with_less(case, name, fails, tries)
    return case


def _with_less(
    case: Case, name: str, fails: Callable[[Case], bool], tries: int
) -> tuple[Case, int]:
    """Pieces of one file left out: halves first, in the end lines or single bytes."""
    size = max(len(case.files[name]) // 2, 1)
    while size and tries > 0:
        at, is_smaller = 0, False
        while at < len(case.files[name]) and tries > 0:
            raw = case.files[name]
            less = replace(case, files={**case.files, name: raw[:at] + raw[at + size :]})
            tries -= 1
            if fails(less):
                case, is_smaller = less, True
            else:
                at += size
        size = size if is_smaller else size // 2
    return case, tries
