"""Work handed over pass by pass: the same bits, and a turn for each pass."""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np
import pytest
from tests.gpu.small import SMALL

from airlight.gpu.commands import Commands
from airlight.gpu.sliced import SlicedCommands
from airlight.rendering import Renderer
from airlight.scene.io import load


def drawn(commands: Commands) -> np.ndarray:
    with Renderer(load("builtin:cornell"), "lpv", (24, 18), settings=SMALL) as r:
        r.view.aim(r.scene.camera, (0.0, 0.0), 0)
        r.technique.solve(commands, r.scene)
        r.technique.draw(commands, r.view)
        commands.submit()
        r.gpu.wait()
        return np.stack([t.read() for t in r.technique.layers(r.view).values()])


def test_an_image_made_pass_by_pass_is_the_same_bits(gpu):
    turns = []

    @contextmanager
    def turn():
        turns.append(1)
        yield

    sliced = drawn(SlicedCommands(gpu, turn))
    assert len(turns) > 30  # shadow maps, reflective maps, hops, G-buffer, ...
    assert np.array_equal(sliced, drawn(Commands(gpu)))
    assert sliced.max() > 0.1


def test_what_a_turn_raises_breaks_the_work_off(gpu):
    class Enough(BaseException):
        pass

    def turn():
        raise Enough

    with pytest.raises(Enough):
        drawn(SlicedCommands(gpu, turn))
