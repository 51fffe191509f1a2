"""Settings of a technique: one frozen dataclass; flags, sliders, keys and docs come from it.

@dataclass(frozen=True)
class LpvSettings:
    resolution: int = setting(32, "cells along the longest side", low=2, high=256)
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar, cast

from ..errors import SettingsError, SettingsWarning, nearest

S = TypeVar("S")


def setting(
    default: Any,
    help: str,
    *,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    choices: Sequence[str] = (),
    former: Mapping[str, str] | None = None,
) -> Any:
    """A dataclass field with its meaning, unit and range.

    `former`: choices that are no longer there, each with the one that is taken instead.
    """
    metadata = {
        "help": help,
        "unit": unit,
        "low": low,
        "high": high,
        "choices": tuple(choices),
        "former": former or {},
    }
    return dataclasses.field(default=default, metadata=metadata)


def given_settings(settings: Mapping[str, Any] | None) -> dict[str, Any]:
    """Settings by name, as they were given. Raises SettingsError for what is no mapping."""
    if settings is not None and not isinstance(settings, Mapping):
        raise SettingsError(f"settings must be a mapping of names to values, not {settings!r:.80}")
    return dict(settings or {})


def make_settings(cls: type[S], values: Mapping[str, Any], *, where: object = "") -> S:
    """An instance of the settings class `cls` with `values` set, each checked.

    Text is parsed ("32", "true", "1,2,3"), so that values may come from a command line.
    Raises SettingsError for an unknown name (naming the nearest), a wrong type or range; warns of a
    choice that is no longer there.
    """
    fields = {f.name: f for f in dataclasses.fields(cast(Any, cls))}
    checked: dict[str, Any] = {}
    for name, value in values.items():
        if name not in fields:
            raise SettingsError(
                f"unknown setting '{name}'", where=where, remedy=nearest(name, fields)
            )
        checked[name] = _checked(fields[name], value, where)
    return cls(**checked)


def _checked(f: dataclasses.Field[Any], value: Any, where: object) -> Any:
    # A setting's kind is that of its default.
    kind = type(f.default)
    try:
        result = _converted(kind, value)
    except (TypeError, ValueError, OverflowError):
        raise SettingsError(
            f"setting {f.name} = {value!r} is not {_KIND_NAMES.get(kind, kind.__name__)}",
            where=where,
        ) from None
    # Of the right kind; now, whether it is one of the choices, and in range.
    choices, low, high = (f.metadata.get(k) for k in ("choices", "low", "high"))
    if choices and (instead := f.metadata["former"].get(result)):
        warnings.warn(
            f"setting {f.name} = {value!r} is no longer there, {instead!r} is taken for it",
            SettingsWarning,
            stacklevel=2,
        )
        result = instead
    if choices and result not in choices:
        raise SettingsError(
            f"setting {f.name} = {value!r} is unknown",
            where=where,
            remedy=f"Choose from {', '.join(choices)}.",
        )
    if isinstance(result, (int, float)) and not isinstance(result, bool):
        below, above = low is not None and result < low, high is not None and result > high
        # NaN, unequal to itself, is in no range.
        if below or above or result != result:
            raise SettingsError(
                f"setting {f.name} = {value!r} is out of range",
                where=where,
                remedy=f"It goes from {low if low is not None else '-inf'} "
                f"to {high if high is not None else 'inf'}.",
            )
    return result


_KIND_NAMES = {
    int: "a whole number",
    float: "a number",
    bool: "true or false",
    str: "text",
    tuple: "numbers",
}
_TRUTH = {
    "true": True,
    "yes": True,
    "on": True,
    "1": True,
    "false": False,
    "no": False,
    "off": False,
    "0": False,
}


def _converted(kind: type, value: Any) -> Any:
    # Text is what a command line has; other values have to be of the kind.
    if kind is bool:
        return value if isinstance(value, bool) else _truth(value)
    if kind is int:
        # A boolean is an integer in Python, and no number here.
        if isinstance(value, bool) or float(value) != int(float(value)):
            raise ValueError
        return int(float(value))
    if kind is float:
        if isinstance(value, bool):
            raise ValueError
        return float(value)
    if kind is str:
        if not isinstance(value, str):
            raise TypeError
        return value
    if kind is tuple:
        parts = value.split(",") if isinstance(value, str) else value
        return tuple(float(part) for part in parts)
    return value


def _truth(value: Any) -> bool:
    try:
        return _TRUTH[str(value).lower()]
    except KeyError:
        raise ValueError from None
