"""What stands in the panel is declared once; what a page says of it is believed only if it fits."""

from __future__ import annotations

import json

import numpy as np
import pytest

from airlight.app.view.widgets import (
    Section,
    Unfit,
    Widget,
    fitting,
    plain,
    sky_angles_deg,
    sky_place,
    told,
)


@pytest.mark.parametrize(
    ("widget", "value", "taken"),
    [
        (Widget("a", "flag", "a", False), True, True),
        (Widget("a", "choice", "a", "x", choices=("x", "y")), "y", "y"),
        (Widget("a", "number", "a", 1.0, low=0.0, high=2.0), 5, 2.0),
        (Widget("a", "whole", "a", 1, low=0, high=9), 3.7, 4),
        (Widget("a", "vector", "a", (1.0, 2.0)), [3, 4.5], (3.0, 4.5)),
        (Widget("a", "colour", "a", (1.0, 1.0, 1.0)), [2.0, 0.5, -1.0], (1.0, 0.5, 0.0)),
        (Widget("a", "button", "a"), "whatever", None),
        (Widget("a", "text", "a", ""), "1, 2", "1, 2"),
    ],
)
def test_what_fits_is_taken(widget, value, taken):
    assert fitting(widget, value) == taken


@pytest.mark.parametrize(
    ("widget", "value"),
    [
        (Widget("a", "flag", "a", False), 1),
        (Widget("a", "choice", "a", "x", choices=("x", "y")), "z"),
        (Widget("a", "choice", "a", "x", choices=("x", "y")), ["x"]),
        (Widget("a", "number", "a", 1.0), float("nan")),
        (Widget("a", "number", "a", 1.0), True),
        (Widget("a", "number", "a", 1.0), 10**400),
        (Widget("a", "vector", "a", (1.0, 2.0)), [1.0]),
        (Widget("a", "vector", "a", (1.0, 2.0)), [1.0, None]),
        (Widget("a", "text", "a", ""), "x" * 1000),
        (Widget("a", "bar", "", (0.5, "")), 1.0),
    ],
)
def test_what_does_not_fit_is_refused(widget, value):
    with pytest.raises(Unfit):
        fitting(widget, value)


def test_a_change_reaches_its_widget_alone():
    heard = []
    sections = [
        Section("one", (Widget("a", "flag", "a", False, heard.append),)),
        Section("two", (Widget("b", "number", "b", 0.0, heard.append), Widget("c", "bar", ""))),
    ]
    assert told(sections, "b", 3)
    assert heard == [3.0]
    assert not told(sections, "b", "three")
    assert not told(sections, "nobody", 1)
    assert not told(sections, "c", 1)
    assert heard == [3.0]


def test_widgets_become_json_and_charts_an_address():
    image = np.zeros((2, 3, 3), np.uint8)
    every = [
        Widget("a", "number", "a", 1.0, low=0.0, high=9.0, is_logarithmic=True),
        Widget("b", "chart", "", image),
        Widget("c", "vector", "c", (1.0, np.float64(2.0)), step=0.5),
    ]
    number, chart, vector = (json.loads(json.dumps(plain(w, lambda _: "data:x"))) for w in every)
    assert (number["low"], number["high"], number["log"]) == (0.0, 9.0, True)
    assert chart["value"] == "data:x"
    assert (vector["value"], vector["step"]) == ([1.0, 2.0], 0.5)


@pytest.mark.parametrize("angles", [(0.0, 90.0), (30.0, 10.0), (-120.0, 45.0)])
def test_the_pad_of_the_sky_goes_both_ways(angles):
    azimuth, elevation = sky_angles_deg(*sky_place(*angles))
    assert elevation == pytest.approx(angles[1])
    if angles[1] < 90.0:
        assert azimuth == pytest.approx(angles[0])
