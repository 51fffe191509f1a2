"""A slice of a grid in false colours, and densities through the transfer function."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.app.view.scene_sections import air
from airlight.app.view.slices import COLOURS, Slice, Sliced, coloured, plane, transferred
from airlight.app.view.state import ViewState
from airlight.scene.builtin.cornell import cornell
from airlight.scene.io import load
from airlight.scene.volume import Volume

GRID = np.arange(2 * 3 * 4, dtype=np.float32).reshape(2, 3, 4)  # z, y, x


def test_planes_have_what_is_up_or_far_at_the_top():
    assert np.array_equal(plane(GRID, Slice("z", 0.0)), GRID[0, ::-1])  # y upwards, x to the right
    assert np.array_equal(plane(GRID, Slice("z", 1.0)), GRID[1, ::-1])
    assert np.array_equal(plane(GRID, Slice("y", 0.5)), GRID[:, 1])  # z towards us, downwards
    assert np.array_equal(plane(GRID, Slice("x", 0.99)), GRID[:, ::-1, 3].T)


def test_the_transfer_function_spreads_what_lies_between_its_ends():
    assert transferred(GRID, Slice(), 23.0) is GRID
    values = np.array([0.0, 5.0, 10.0, 15.0, 20.0], np.float32)
    assert np.allclose(transferred(values, Slice(low=0.25, high=0.75), 20.0), [0, 0, 10, 20, 20])
    step = transferred(values, Slice(low=0.5, high=0.5), 20.0)
    assert np.allclose(step, [0, 0, 0, 20, 20])


@pytest.mark.parametrize("colours", COLOURS)
def test_colours_grow_lighter_or_change_hue_and_end_where_they_should(colours):
    shown = coloured(np.linspace(0.0, 1.0, 64), colours).astype(int)
    assert np.abs(np.diff(shown, axis=0)).max() < 24  # no bands
    assert len(np.unique(shown, axis=0)) == 64
    if colours != "cool to warm":
        luma = shown @ (0.2126, 0.7152, 0.0722)
        assert np.all(np.diff(luma) >= 0.0)


def test_a_chart_shows_the_slice_and_is_made_once():
    sliced = Sliced(GRID, Slice("z", 0.0, "grey"))
    chart = sliced.chart
    assert sliced.chart is chart
    assert chart.shape[1:] == (240, 3)
    assert chart[0, -1, 0] > chart[0, 0, 0]  # x to the right: densities grow
    assert sliced.seen(replace(sliced.view, share=1.0)).chart[0, 0, 0] > chart[0, 0, 0]


def test_what_is_cut_off_is_rendered_so_and_comes_back():
    volume = Volume((1.0, 1.0, 1.0), density=GRID)
    state = ViewState(replace(cornell(), volumes=(volume,)))
    own = state.scene.volumes[0].density
    widgets = {widget.key: widget for widget in air(state)}
    widgets["volume.0.slice.low"].change(11.5)
    now = state.scene.volumes[0].density
    assert now.min() == 0.0
    assert np.count_nonzero(now) == 12
    assert now.max() == pytest.approx(23.0)
    {w.key: w for w in air(state)}["volume.0.slice.low"].change(0.0)
    assert np.array_equal(state.scene.volumes[0].density, own)
    before = state.scene
    {w.key: w for w in air(state)}["volume.0.slice.axis"].change("x")
    assert state.scene is before  # only looked at otherwise


def test_densities_that_move_are_cut_off_as_those_of_the_first_moment():
    scene = load("builtin:smoke")
    state = ViewState(scene)
    view = replace(state.sliced[0].view, low=0.3)
    plain = scene.at(1.0).volumes[0].density
    state.put_slice(0, view)
    state.time_s = 1.0
    cut = state.moved().volumes[0].density
    assert np.allclose(cut, transferred(plain, view, state.sliced[0].top))
    assert np.count_nonzero(cut) < np.count_nonzero(plain)
