"""How a value is described: its name, kind, unit, default and meaning.

Scene files are checked against such descriptions, and the reference page is printed from them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import date, datetime, time
from functools import partial
from typing import Any

from ..errors import SceneError, nearest
from . import checks


@dataclass(frozen=True)
class Kind:
    """What values may be, in `words` for the reference page.

    `check` takes what was written and the key path for messages, and gives the checked value.
    """

    words: str
    check: Callable[[Any, str], Any]


@dataclass(frozen=True)
class Key:
    """One key of a table: `default` is words for the reference page."""

    name: str
    kind: Kind
    doc: str
    unit: str = ""
    default: str = ""
    required: bool = False


def one_of(*choices: str) -> Kind:
    """One of several texts."""

    def check(value: Any, name: str) -> str:
        word = checks.text(value, name)
        if word not in choices:
            raise SceneError(f"{name} = '{word}' is unknown", remedy=nearest(word, choices))
        return word

    quoted = [f'"{name}"' for name in choices]
    return Kind(f"{', '.join(quoted[:-1])} or {quoted[-1]}", check)


def within(low: float, high: float) -> Kind:
    """A number in [low, high]."""
    return Kind("number", partial(checks.number, low=low, high=high))


def _local_date(value: Any, name: str) -> date:
    # A date with a time of day is a date to Python, too.
    if isinstance(value, datetime) or not isinstance(value, date):
        raise SceneError(f"{name} = {checks.shown(value)} is no date", remedy="Write 2026-06-21.")
    return value


def _local_time(value: Any, name: str) -> time:
    if not isinstance(value, time):
        raise SceneError(f"{name} = {checks.shown(value)} is no time", remedy="Write 17:30:00.")
    return value


NUMBER = Kind("number", checks.number)
FRACTION = within(0.0, 1.0)
BOOLEAN = Kind("boolean", checks.boolean)
TEXT, PATH = Kind("text", checks.text), Kind("path", checks.text)
VECTOR, UNIT_VECTOR = Kind("vector", checks.vec3), Kind("vector", checks.unit_vec3)
COLOUR = Kind("colour", checks.rgb)  # three numbers, or one for grey
REFLECTANCE = Kind("colour", partial(checks.rgb, high=1.0))
BOUNDS = Kind("two corners", checks.bounds)
SIZE_PX = Kind("two whole numbers", checks.size_px)
STOPS = Kind('number or "auto"', checks.stops)
LOCAL_DATE, LOCAL_TIME = Kind("date", _local_date), Kind("time", _local_time)  # as TOML has them
