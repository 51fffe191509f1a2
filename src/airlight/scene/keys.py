"""How a value is described: its name, check, unit, default and meaning.

Scene files are checked against such descriptions, and the reference page is printed from them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import date, datetime, time
from typing import Any

from ..errors import SceneError, nearest
from . import checks

Check = Callable[[Any, str], Any]
"""Takes what was written and the key path for messages; gives the checked value."""


@dataclass(frozen=True)
class Key:
    """One key of a table: `kind` and `default` are words for the reference page."""

    name: str
    check: Check
    kind: str
    doc: str
    unit: str = ""
    default: str = ""
    required: bool = False


def one_of(*choices: str) -> Check:
    """A check that a text is one of `choices`."""

    def check(value: Any, name: str) -> str:
        word = checks.text(value, name)
        if word not in choices:
            raise SceneError(f"{name} = '{word}' is unknown", remedy=nearest(word, choices))
        return word

    return check


def within(low: float, high: float) -> Check:
    """A check that a number is in [low, high]."""

    def check(value: Any, name: str) -> float:
        return checks.number(value, name, low=low, high=high)

    return check


def local_date(value: Any, name: str) -> date:
    """A check for TOML's local dates."""
    # A date with a time of day is a date to Python, too.
    if isinstance(value, datetime) or not isinstance(value, date):
        raise SceneError(f"{name} = {checks.shown(value)} is no date", remedy="Write 2026-06-21.")
    return value


def local_time(value: Any, name: str) -> time:
    """A check for TOML's local times."""
    if not isinstance(value, time):
        raise SceneError(f"{name} = {checks.shown(value)} is no time", remedy="Write 17:30:00.")
    return value
