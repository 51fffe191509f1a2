"""Which way dimensions go: by attributes, units and names; the others get the remaining letters."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.io.dense_grid import SAID, TAKEN
from airlight.scene.io.netcdf_axes import Axis, is_downwards, is_measured, letter_of, lettered


@pytest.mark.parametrize(
    ("name", "attributes", "letter"),
    [
        ("p", {"axis": "z"}, "Z"),
        ("p", {"standard_name": "height_above_mean_sea_level"}, "Z"),
        ("p", {"standard_name": "atmosphere_hybrid_sigma_pressure_coordinate"}, "Z"),
        ("p", {"standard_name": "depth"}, "Z"),
        ("p", {"standard_name": "longitude"}, "X"),
        ("p", {"positive": "down"}, "Z"),
        ("p", {"units": "hPa"}, "Z"),
        ("p", {"units": "millibars"}, "Z"),
        ("p", {"units": "degrees_north"}, "Y"),
        ("p", {"units": "hours since 2000-01-01"}, "T"),
        ("p", {"units": "s"}, "T"),
        ("p", {"units": "minutes"}, "T"),
        ("p", {"units": "m"}, ""),
        ("z", {"units": "s"}, "Z"),
        ("ocean_time", {}, "T"),
        ("step", {}, "T"),
        ("altitude", {}, "Z"),
        ("model_level", {}, "Z"),
        ("sigma", {}, "Z"),
        ("bottom_top", {}, "Z"),
        ("northing", {}, "Y"),
        ("easting", {}, "X"),
        ("theta", {}, ""),
    ],
)
def test_attributes_come_before_units_and_units_before_names(name, attributes, letter):
    assert letter_of(name, attributes) == letter


def axes(*letters):
    return [Axis(f"d{k}", letter, 2, None, "") for k, letter in enumerate(letters)]


@pytest.mark.parametrize(
    ("letters", "order", "how", "told"),
    [
        ("XYZ", "d2 d1 d0", SAID, ""),
        (("", "", "Z"), "d2 d0 d1", SAID, "d0, d1 are y, x"),
        (("X", "", "Y"), "d1 d2 d0", SAID, "d1 is height"),
        (("", "", ""), "d0 d1 d2", TAKEN, "d0, d1, d2 are height, y, x (--up y takes d1 as up)"),
        (("X", "", ""), "d1 d2 d0", TAKEN, "d1, d2 are height, y (--up y takes d2 as up)"),
        (("X", "X", "Z"), "d2 d0 d1", SAID, "d0, d1 are y, x"),
    ],
)
def test_axes_that_say_nothing_get_the_remaining_letters(letters, order, how, told):
    found, upright, doubts = lettered(axes(*letters), "a.nc")
    assert [axis.letter for axis in found] == ["Z", "Y", "X"]
    assert " ".join(axis.name for axis in found) == order and upright == how
    assert told in " ".join(doubts) and bool(doubts) == bool(told)


def test_depths_grow_downwards_unless_they_say_otherwise_or_are_below_0():
    deep = np.array([1.0, 2.0])
    assert is_downwards("depth", {}, deep) and is_downwards("p", {"standard_name": "depth"}, deep)
    assert not is_downwards("depth", {}, -deep)
    assert not is_downwards("depth", {"positive": "up"}, deep)
    assert is_downwards("z", {"positive": "down"}, deep) and not is_downwards("z", {}, deep)


def test_units_that_say_where_cells_are():
    for units in ("m", "Km", "metres", "Micrometers", "hPa", "millibars", "degrees_east"):
        assert is_measured({"units": units}), units
    for units in ("", "1", "level", "K"):
        assert not is_measured({"units": units}), units
