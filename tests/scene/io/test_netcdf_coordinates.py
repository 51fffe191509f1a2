"""Where cells are: a dimension's own coordinate, one beside it, or a map of two dimensions."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.io.netcdf_coordinates import axis_of

pytestmark = pytest.mark.needs("xarray")
INDEX = np.arange(3.0)


def variable(**coords):
    import xarray

    return xarray.DataArray(np.zeros((3, 3, 3)), dims=("k", "j", "i"), coords=coords)


def test_what_says_where_cells_are_wins():
    heights = ("k", 10.0 * INDEX, {"units": "m", "positive": "up"})
    # Numbers of levels say less than heights beside them, and heights in metres are all there is.
    for own in ({}, {"k": ("k", INDEX)}):
        axis = axis_of(variable(height=heights, **own), "k", {})
        assert (axis.name, axis.letter, axis.units) == ("k", "Z", "m")
        np.testing.assert_array_equal(axis.centres, 10.0 * INDEX)
    own = ("k", 5.0 * INDEX, {"units": "m"})
    np.testing.assert_array_equal(
        axis_of(variable(height=heights, k=own), "k", {}).centres, 5 * INDEX
    )
    # What does not say which way it goes is none, and attributes of WRF come before maps.
    assert axis_of(variable(other=("j", INDEX)), "j", {}).centres is None
    assert axis_of(variable(), "j", {"j": INDEX}).units == "m"


def test_a_map_of_two_dimensions_is_taken_as_straight():
    north, east = 48.0 + 0.1 * INDEX, 11.0 + 0.1 * INDEX
    for bend in (0.0, 0.02):
        lat = (("j", "i"), north[:, None] + bend * INDEX, {"units": "degrees_north"})
        lon = (("j", "i"), east - bend * INDEX[:, None], {"units": "degrees_east"})
        made = variable(lat=lat, lon=lon)
        y, x = axis_of(made, "j", {}), axis_of(made, "i", {})
        assert (y.letter, x.letter) == ("Y", "X")
        np.testing.assert_allclose(np.diff(y.centres), 0.1)
        np.testing.assert_allclose(np.diff(x.centres), 0.1)
        said = "'lat' is curved, and taken as straight along 'j'"
        assert y.doubt == (said if bend else "")


def test_levels_that_are_shares_of_the_pressure_are_pressures():
    levels = np.array([1.0, 0.5, 0.1])
    for name, said in (("sigma", ""), ("k", "atmosphere_hybrid_sigma_pressure_coordinate")):
        made = variable(**{name: ("k", levels, {"standard_name": said, "positive": "down"})})
        axis = axis_of(made, "k", {})
        assert (axis.letter, axis.units, axis.is_down) == ("Z", "Pa", False)
        np.testing.assert_allclose(axis.centres, 101325.0 * levels)
