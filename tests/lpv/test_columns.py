"""Tiles of any size make the same light."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import buffer_of
from airlight.lattice.placement import Placement
from airlight.lpv import propagate, step
from airlight.lpv.columns import column_march


@pytest.mark.parametrize("tile", [(1, 1), (2, 2), (3, 2), (2, 4)])
def test_the_tile_does_not_change_the_light(gpu, commands, owned, monkeypatch, tile):
    count = (7, 5, 9)
    states = np.random.default_rng(5).normal(size=(3, 9, 5, 7, 4)).astype(np.float32)
    faces = np.random.default_rng(6).integers(0, 1 << 32, 9 * 5 * 7 * 8, dtype=np.uint32)
    lights = []
    for used in ((2, 4), tile):
        monkeypatch.setattr(step, "_CPU_TILE", used)
        monkeypatch.setattr(step, "_CPU_OPEN_TILE", used)
        made = owned(
            propagate.Propagate(
                gpu, Placement((0, 0, 0), 1.0, count), is_blocked=True, is_reflecting=True
            )
        )
        total = made.encode(
            commands, owned(buffer_of(gpu, "i", states)), owned(buffer_of(gpu, "f", faces)), 3
        )
        commands.submit()
        lights.append(total.read().copy())
    np.testing.assert_allclose(lights[1], lights[0], atol=2e-6 * np.abs(lights[0]).max())


def test_a_tile_reads_each_of_its_cells_once():
    text = column_march(2, 4, 8)
    inside = text[text.index("for (var z") :]
    assert inside.count("light_at(") == 2 * 4 + 2 * (2 + 4)
    assert inside.count("put(") == 2 * 4
