"""Every setting of every technique gets a control, with its unit, range and help."""

from __future__ import annotations

from dataclasses import dataclass, fields

import pytest

from airlight.app.view.panel import checked, controls, shown_value
from airlight.errors import SettingsError
from airlight.scene.settings import setting
from airlight.techniques import TECHNIQUES, technique_settings


@dataclass(frozen=True)
class Example:
    steps: int = setting(8, "how many", low=1, high=4096)
    reach: float = setting(1.0, "how far", unit="m", low=0.5, high=2.0)
    fast: bool = setting(True, "whether")
    scheme: str = setting("auto", "which", choices=("auto", "off"))
    bounds: tuple[float, ...] = setting((), "where", unit="m")


def test_kinds_ranges_and_units():
    steps, reach, fast, scheme, bounds = controls(Example)
    assert [c.kind for c in (steps, reach, fast, scheme, bounds)] == [
        "whole",
        "number",
        "flag",
        "choice",
        "text",
    ]
    assert (steps.low, steps.high, steps.is_logarithmic) == (1, 4096, True)
    assert (reach.label, reach.is_logarithmic) == ("reach (m)", False)
    assert scheme.choices == ("auto", "off")
    assert "how far" in reach.tip and "-D reach=" in reach.tip
    assert not bounds.is_logarithmic
    assert "default none" in bounds.tip


def test_values_are_checked_and_defaults_left_out():
    assert checked(Example, {}, "steps", 9) == {"steps": 9}
    assert checked(Example, {}, "steps", 8) == {}
    assert checked(Example, {"steps": 9}, "steps", 8) == {"steps": 8}  # over the scene file's
    assert checked(Example, {"steps": "16"}, "fast", False) == {"steps": 16, "fast": False}
    assert checked(Example, {}, "bounds", "0,0,0,1,1,1") == {"bounds": (0, 0, 0, 1, 1, 1)}
    with pytest.raises(
        SettingsError, match=r"reach = 3.0 is out of range\. It goes from 0\.5 to 2\.0"
    ):
        checked(Example, {}, "reach", 3.0)


def test_values_from_the_command_line_are_shown_as_what_they_mean():
    steps, _, fast, scheme, bounds = controls(Example)
    given = {"steps": "16", "fast": "off", "scheme": "off", "bounds": (0.0, 1.5)}
    assert shown_value(steps, given) == 16
    assert shown_value(fast, given) is False
    assert shown_value(scheme, given) == "off"
    assert shown_value(bounds, given) == "0, 1.5"
    assert shown_value(steps, {"steps": "many"}) == 8


@pytest.mark.parametrize("name", list(TECHNIQUES))
def test_every_technique_has_a_panel(name):
    made = controls(technique_settings(name))
    assert len(made) == len(fields(technique_settings(name)))
    for control in made:
        assert control.help, control.name
        if control.kind == "number":
            assert control.low is not None and control.high is not None, control.name
