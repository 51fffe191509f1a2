"""A slice of a grid in false colours, and densities through the transfer function."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from airlight.app.view.air_section import air
from airlight.app.view.sections import _time
from airlight.app.view.slices import (
    COLOURS,
    Slice,
    Sliced,
    caption,
    coloured,
    fullest,
    plane,
    transferred,
)
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


def smoke_file(path, steps: int) -> str:
    """A scene file with a sequence of grids, of which each has its smoke one row higher."""
    for k in range(steps):
        grid = np.zeros((2, 6, 2), np.float32)
        grid[:, k] = 1.0 + k
        np.save(path / f"smoke_{k}.npy", grid)
    scene = path / "smoke.toml"
    scene.write_text(
        '[[volume]]\nsequence = "smoke_*.npy"\nsequence_fps = 2\n'
        "sigma_t = 3.0\nbounds = [[0, 0, 0], [1, 3, 1]]\n"
    )
    return str(scene)


def widgets_of(state: ViewState) -> dict:
    return {widget.key: widget for widget in air(state)}


def test_the_slice_lies_where_most_is_and_says_where_that_is_in_metres():
    grid = np.zeros((4, 10, 3), np.float32)
    grid[1, 7] = 2.0
    assert fullest(grid, "y") == pytest.approx(0.75)
    assert fullest(grid, "z") == pytest.approx(1.5 / 4)
    assert fullest(np.ones_like(grid), "x") == pytest.approx(0.5)
    volume = Volume((1.0, 1.0, 1.0), density=grid, bounds=((0.0, 100.0, 0.0), (6.0, 300.0, 8.0)))
    state = ViewState(replace(cornell(), volumes=(volume,)))
    widgets = widgets_of(state)
    at = widgets["volume.0.slice.share"]
    assert (at.low, at.value, at.high) == pytest.approx((100.0, 250.0, 300.0))
    at.change(120.0)
    assert state.sliced[0].view.share == pytest.approx(0.1)
    widgets["volume.0.slice.axis"].change("z")
    assert widgets_of(state)["volume.0.slice.share"].value == pytest.approx(3.0)
    assert "(m)" in at.label
    assert widgets_of(state)["volume.0.slice.caption"].value.splitlines() == [
        "right: x, 0 to 6 m",
        "up: y, 100 to 300 m",
        "colours: density 0 to 2,",
        "extinction 0 to 2 1/m",
    ]


@pytest.mark.parametrize("axis", "xyz")
def test_a_plane_has_the_shape_that_it_has_in_the_world(axis):
    grid = np.ones((10, 10, 10), np.float32)
    box = np.array([(0.0, 0.0, 0.0), (2.0, 4.0, 8.0)])
    sliced = Sliced(grid, Slice(axis, colours="grey"), box)
    is_white = (sliced.chart[:-56] == 255).all(axis=-1)
    wide, tall = is_white.any(axis=0).sum(), is_white.any(axis=1).sum()
    assert (wide, tall) == {"x": (240, 120), "y": (60, 240), "z": (120, 240)}[axis]
    # North, which is -z, is up in a plane across y.
    if axis == "y":
        assert caption(sliced, 0.5).startswith("right: x, 0 to 2 m\nup: -z, -8 to 0 m\n")


def test_the_slice_follows_the_time_step_by_step(tmp_path):
    state = ViewState(load(smoke_file(tmp_path, 3)))
    first = state.sliced_now(0)
    assert state.sliced_now(0) is first
    time = {widget.key: widget for widget in _time(SimpleNamespace(state=state))}
    step = time["step"]
    assert (step.kind, step.low, step.value, step.high) == ("whole", 1, 1, 3)
    assert step.label == "step, of 3"
    step.change(3)
    assert state.time_s == pytest.approx(1.0)
    third = state.sliced_now(0)
    assert third.density.max() == 3.0
    assert not np.array_equal(third.chart, first.chart)
    assert third.top == first.top  # colours mean the same at all times
    # What is cut off at one time is cut off in its chart, too.
    widgets_of(state)["volume.0.slice.low"].change(0.5)
    assert state.sliced_now(0).view.low == pytest.approx(0.5 / first.top)
    assert {w.key: w for w in _time(SimpleNamespace(state=state))}["step"].value == 3


def test_extinction_is_of_the_densest_voxel_in_a_unit_that_needs_no_file():
    grid = GRID * np.float32(1e-4 / 23.0)
    volume = Volume((56e3, 28e3, 56e3), density=grid)
    state = ViewState(replace(cornell(), volumes=(volume,)))
    sigma = widgets_of(state)["volume.0.sigma"]
    assert sigma.value == pytest.approx(5.6)
    assert sigma.low < sigma.value < sigma.high
    sigma.change(11.2)
    assert state.scene.volumes[0].sigma_t == pytest.approx((112e3, 56e3, 112e3))
    assert sigma.label == "volume: extinction (1/m)"
    assert sigma.tip == "Of the densest voxel"
