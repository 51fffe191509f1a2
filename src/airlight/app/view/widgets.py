"""What stands in the panel, declared once: imgui draws it in windows, HTML in pages and notebooks.

A section lists widgets, a widget says what it is, what it stands at and what `change` does with
another value. Neither knows a toolkit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ...maths.arrays import F64, U8

Kind = Literal[
    "flag",
    "choice",
    "number",
    "whole",
    "text",
    "vector",
    "colour",
    "sky",
    "button",
    "chart",
    "bar",
    "note",
]
"""flag: a bool. choice: one of `choices`. number, whole: a slider where `low` and `high` are known.
text: a line. vector: numbers, metres. colour: red, green, blue in 0 to 1. sky: (azimuth, elevation)
in degrees of what shines. button: `change` is called with None. chart: an image (h, w, 3) uint8.
bar: (share of the width, text). note: lines to be read."""
_LONGEST_TEXT = 200
_FARTHEST = 1e12


@dataclass(frozen=True)
class Widget:
    """One control. `key` is unique in its panel and stays the same from frame to frame.

    `waits`: it counts when a hand lets go of it, because what it changes takes long. `beside`: it
    stands beside the one before. `step`: what one pixel of a drag is worth, of a vector.
    """

    key: str
    kind: Kind
    label: str
    value: Any = None
    change: Callable[[Any], None] | None = None
    low: float | None = None
    high: float | None = None
    is_logarithmic: bool = False
    choices: tuple[str, ...] = ()
    tip: str = ""
    waits: bool = False
    beside: bool = False
    step: float = 0.01


@dataclass(frozen=True)
class Section:
    """Widgets under a heading; `is_open` until a hand shuts it."""

    name: str
    widgets: tuple[Widget, ...]
    is_open: bool = True


class Unfit(Exception):
    """A value that a widget cannot stand at."""


def fitting(widget: Widget, value: Any) -> Any:
    """`value`, from a page, as `widget.change` takes it. Raises Unfit."""
    match widget.kind:
        case "flag":
            return _if(isinstance(value, bool), value)
        case "choice":
            return _if(value in widget.choices, value)
        case "button":
            return None
        case "number":
            return _number(value, widget.low, widget.high)
        case "whole":
            return round(_number(value, widget.low, widget.high))
        case "text":
            return _if(isinstance(value, str) and len(value) <= _LONGEST_TEXT, value)
        case "vector" | "sky":
            return _numbers(value, len(widget.value))
        case "colour":
            return tuple(min(max(c, 0.0), 1.0) for c in _numbers(value, 3))
        case _:
            raise Unfit


def told(sections: Iterable[Section], key: str, value: Any) -> bool:
    """Change the widget of that `key`; false where there is none, or the value does not fit."""
    # The key of a widget is unique, so the first one that has it is meant.
    for section in sections:
        for widget in section.widgets:
            if widget.key == key and widget.change is not None:
                try:
                    widget.change(fitting(widget, value))
                except Unfit:
                    return False
                return True
    return False


def sky_place(azimuth_deg: float, elevation_deg: float) -> F64:
    """Where on the pad of a "sky" a direction is: (2,) in -1 to 1, x to +X, y to +Z, 0 above."""
    # Distance from the middle is the angle from above; a little beyond the rim lies the horizon.
    away = min((90.0 - elevation_deg) / 90.0, 1.05)
    a = math.radians(azimuth_deg)
    return np.array([math.sin(a), math.cos(a)]) * away


def sky_angles_deg(x: float, y: float) -> tuple[float, float]:
    """(azimuth, elevation) at a place of the pad: the inverse of `sky_place` above the horizon."""
    elevation = min(max(90.0 * (1.0 - math.hypot(x, y)), -5.0), 90.0)
    return math.degrees(math.atan2(x, y)), elevation


def plain(widget: Widget, encode: Callable[[U8], str]) -> Mapping[str, Any]:
    """The widget as JSON has it; `encode` makes an address of a chart."""
    value = widget.value
    if widget.kind == "chart":
        value = encode(value)
    elif isinstance(value, (tuple, list)):
        value = [float(v) if isinstance(v, (int, float)) else v for v in value]
    known: dict[str, Any] = {
        "key": widget.key,
        "kind": widget.kind,
        "label": widget.label,
        "value": value,
        "tip": widget.tip,
    }
    # Keys that say nothing are left out: the panel is sent whenever a value changes.
    rare = {
        "low": widget.low,
        "high": widget.high,
        "log": widget.is_logarithmic,
        "choices": list(widget.choices),
        "waits": widget.waits,
        "beside": widget.beside,
        "step": widget.step if widget.kind == "vector" else None,
    }
    said = {n: v for n, v in rare.items() if v is not None and v is not False and v != []}
    return {**known, **said}


def _if(is_so: bool, value: Any) -> Any:
    if not is_so:
        raise Unfit
    return value


def _number(value: Any, low: float | None, high: float | None) -> float:
    # Infinite and huge numbers would break what they set.
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not (is_number and abs(value) <= _FARTHEST):
        raise Unfit
    least, most = -_FARTHEST if low is None else low, _FARTHEST if high is None else high
    return float(min(max(value, least), most))


def _numbers(value: Any, count: int) -> tuple[float, ...]:
    if not isinstance(value, list) or len(value) != count:
        raise Unfit
    return tuple(_number(v, None, None) for v in value)
