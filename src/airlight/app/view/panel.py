"""What the panel shows for a technique's settings, derived from their dataclass."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, Literal, cast

from ...errors import SettingsError
from ...scene.settings import make_settings

Kind = Literal["flag", "choice", "whole", "number", "text"]
_LOG_RATIO = 50.0  # ranges wider than this slide logarithmically


@dataclasses.dataclass(frozen=True)
class Control:
    """One setting. `low` and `high` are None where the setting has no such bound."""

    name: str
    kind: Kind
    default: Any
    help: str
    unit: str
    low: float | None
    high: float | None
    choices: tuple[str, ...]

    @property
    def label(self) -> str:
        """The name in words, with the unit."""
        words = self.name.replace("_", " ")
        return f"{words} ({self.unit})" if self.unit else words

    @property
    def is_logarithmic(self) -> bool:
        """Whether equal steps of a slider should be equal ratios."""
        if self.low is None or self.high is None:
            return False
        return self.high > _LOG_RATIO * max(self.low, 1e-6) and self.low >= 0.0

    @property
    def tip(self) -> str:
        """What a person who hesitates over it wants to know."""
        shown = ", ".join(f"{v:g}" for v in self.default) if self.kind == "text" else self.default
        return f"{self.help}\ndefault {shown if shown != '' else 'none'}; -D {self.name}=..."


def controls(settings: type) -> tuple[Control, ...]:
    """A control for every field of a settings class, in its order."""
    return tuple(_control(field) for field in dataclasses.fields(cast(Any, settings)))


def _control(field: dataclasses.Field[Any]) -> Control:
    m = field.metadata
    return Control(
        field.name,
        _kind(field),
        field.default,
        m.get("help", ""),
        m.get("unit", ""),
        m.get("low"),
        m.get("high"),
        tuple(m.get("choices", ())),
    )


def _kind(field: dataclasses.Field[Any]) -> Kind:
    default = field.default
    # By the default's own type; booleans before numbers, as they are integers in Python.
    if isinstance(default, bool):
        return "flag"
    if field.metadata.get("choices"):
        return "choice"
    if isinstance(default, int):
        return "whole"
    return "number" if isinstance(default, float) else "text"


def checked(settings: type, values: Mapping[str, Any], name: str, value: Any) -> dict[str, Any]:
    """`values` with `name` set; what equals its default is left out. Raises SettingsError."""
    made: Any = make_settings(settings, {**values, name: value})
    defaults = {c.name: c.default for c in controls(settings)}
    every = {key: getattr(made, key) for key in (*values, name)}
    return {key: v for key, v in every.items() if v != defaults[key] or key in values}


def shown_value(control: Control, values: Mapping[str, Any]) -> Any:
    """What the setting stands at; texts of numbers are joined by commas."""
    value = values.get(control.name, control.default)
    if isinstance(value, str) and control.kind not in ("text", "choice"):
        value = _parsed(control, value)
    if control.kind == "text" and not isinstance(value, str):
        return ", ".join(f"{v:g}" for v in value)
    return value


def _parsed(control: Control, text: str) -> Any:
    """A value that came as text from the command line."""
    # Checked as a setting of its own, by the default's kind.
    one = dataclasses.make_dataclass(
        "One", [(control.name, Any, dataclasses.field(default=control.default, metadata={}))]
    )
    try:
        return getattr(make_settings(one, {control.name: text}), control.name)
    except SettingsError:
        return control.default
