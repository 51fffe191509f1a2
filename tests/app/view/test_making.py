"""Renderers made while the one before goes on."""

from __future__ import annotations

import pytest

from airlight.app.view.build import Turns
from airlight.app.view.making import Making
from airlight.errors import SettingsError
from airlight.rendering import Renderer
from airlight.scene.io import load
from small_viewer import SETTINGS as SMALL


@pytest.fixture
def making(gpu):
    made = Making(gpu, Turns())
    yield made
    made.close()


def maker(made: list[int], **settings):
    def make() -> Renderer:
        made.append(1)
        return Renderer(load("builtin:cornell"), "direct", (16, 9), settings={**SMALL, **settings})

    return make


def test_it_comes_solved_and_drawn(making):
    made: list[int] = []
    making.begin(("a",), maker(made))
    assert making.is_under_way
    structure, drawn = making.take()
    assert structure == ("a",)
    assert drawn.renderer.view.layers.direct.read()[..., :3].max() > 0.1
    solves = []
    drawn.renderer.technique.solve = lambda *a, **named: solves.append(1)
    drawn.solve(drawn.renderer.commands)
    assert not solves
    drawn.close()
    assert not making.is_under_way


def test_one_asked_for_twice_is_made_once_and_an_older_wish_is_dropped(making, gpu):
    first: list[int] = []
    second: list[int] = []
    before = gpu.allocated_bytes
    making.begin(("a",), maker(first))
    making.begin(("a",), maker(first))
    while not making.is_under_way or making.wanted != ("b",):
        making.begin(("b",), maker(second))
    structure, drawn = making.take()
    assert (structure, len(first), len(second)) == (("b",), 1, 1)
    drawn.close()
    assert gpu.allocated_bytes == before  # what was broken off left nothing behind


def test_a_refusal_is_raised_when_it_is_taken(making):
    making.begin(("a",), maker([], bounds="1,2"))
    with pytest.raises(SettingsError, match="setting bounds has 2 numbers"):
        making.take()
    assert not making.is_under_way


def test_closing_in_the_middle_leaves_nothing_behind(making, gpu):
    before = gpu.allocated_bytes
    making.begin(("a",), maker([]))
    making.close()
    assert gpu.allocated_bytes == before
