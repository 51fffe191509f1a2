"""Long passes in bands, so that whoever waits for the device need not wait for a whole pass.

A full-screen triangle is drawn row by row of pixels, by a scissor. A dispatch always begins at
workgroup 0, so the compute passes that say `in_bands` get a wrapper around their entry, which adds
the workgroups of the bands before. Commands say how many bands there are: those of a frame take
one, those in the background as many as keep each near `AIM_S`.
"""

from __future__ import annotations

import re
from collections.abc import Hashable

from .layout import Struct, u32, vec3u
from .slots import uniform

AIM_S = 0.025
"""Of a band: with a frame of 65 ms and what a thread waits for the interpreter, below 150 ms."""
_FIRST_SHARE = 32  # of a pass nothing is known of: it may be slow, or compiled by its first band

ENTRY = "banded"
_MAIN = re.compile(r"@compute @workgroup_size\(WX, WY, WZ\)(\s*)fn main\(((?:[^()]|\([^()]*\))*)\)")
_PARAMETER = re.compile(r"@builtin\((\w+)\)\s*(\w+)\s*:\s*(\w+)")
_BEFORE = {
    "global_invocation_id": " + band.first * vec3u(WX, WY, WZ)",
    "workgroup_id": " + band.first",
    "local_invocation_id": "",
    "local_invocation_index": "",
}


class Band(Struct):
    """Where a band of a dispatch begins."""

    first = vec3u("workgroups of the bands before it")
    pad = u32()


BAND = uniform("band", Band)


def banded(text: str) -> tuple[str, str]:
    """A shader's text with `main` as a plain function, and the entry that calls it for a band.

    Raises ValueError where its entry asks for what bands cannot give, such as the number of all
    workgroups.
    """
    # A band runs part of the workgroups; it can make up for its offset, not for the number of all.
    found = _MAIN.search(text)
    taken = _PARAMETER.findall(found[2]) if found else []
    if found is None or any(builtin not in _BEFORE for builtin, _, _ in taken):
        raise ValueError("a pass in bands knows its invocation and its workgroup alone")
    # The entry hands on the builtins, with what lies before the band added.
    plain = re.sub(r"@builtin\(\w+\)\s*", "", found[2])
    given = ", ".join(name + _BEFORE[builtin] for builtin, name, _ in taken)
    entry = (
        f"@compute @workgroup_size(WX, WY, WZ) fn {ENTRY}({found[2].strip()}) {{\n"
        f"    main({given});\n}}\n"
    )
    return text.replace(found[0], f"{found[1]}fn main({plain})"), entry


def longest(groups: tuple[int, ...]) -> tuple[int, int]:
    """The axes along which a dispatch of `groups` is divided: into layers, and those into rows."""
    # The longest axis leads; of equal ones the last, whose workgroups lie farthest apart.
    first, second, *_ = sorted(range(len(groups)), key=lambda axis: (-groups[axis], -axis))
    return first, second


def part(
    groups: tuple[int, ...], first: int, count: int
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Where rows `first` to `first + count` of a dispatch begin, and how many workgroups they are.

    They are whole layers, or within one.
    """
    # The first row, by its layer and its place within; whole layers where there are as many.
    layers, rows = longest(groups)
    begin, size = [0] * len(groups), list(groups)
    begin[layers], begin[rows] = divmod(first, groups[rows])
    whole = count // groups[rows]
    size[layers], size[rows] = (whole, groups[rows]) if whole else (1, count)
    return tuple(begin), tuple(size)


class Pace:
    """How much of a pass takes about `AIM_S`, as its bands before this one tell."""

    def __init__(self) -> None:
        self._unit_s: dict[Hashable, float] = {}

    def next(self, key: Hashable, first: int, count: int, layer: int) -> int:
        """How many of the `count` rows of a pass the next band has, from `first` on.

        Those are whole layers of so many rows, or lie within a `layer`.
        """
        # Of an unknown pass a small share; else equal bands that take about the time aimed for.
        left, unit_s = count - first, self._unit_s.get(key)
        if unit_s is None:
            size = min(left, -(-count // _FIRST_SHARE))
        else:
            size = -(-left // max(1, round(left * unit_s / AIM_S + 0.4)))

        # Up to the end of a layer, then in whole layers.
        before = first % layer
        return size - size % layer if size >= layer > before == 0 else min(size, layer - before)

    def took(self, key: Hashable, count: int, spent_s: float) -> None:
        """A band of `count` took so long."""
        # A slow one counts at once; after a quick one the next is at most twice as large.
        now, before = spent_s / count, self._unit_s.get(key, 0.0)
        self._unit_s[key] = max(now, 0.5 * (now + before))
