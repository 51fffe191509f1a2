"""Lanes that share rows make the light of tiles, however the lattice is cut."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.lanes import Rows, has_row_lanes
from airlight.gpu.memory import buffer_of
from airlight.lattice.placement import Placement
from airlight.lpv import step
from airlight.lpv.propagate import Propagate
from airlight.lpv.rows import row_march


@pytest.mark.parametrize("scheme", ["centroid", "paper"])
@pytest.mark.parametrize("is_blocked", [False, True])
@pytest.mark.parametrize("count", [(8, 8, 9), (6, 5, 18), (40, 1, 5), (70, 2, 2)])
def test_lanes_in_rows_do_not_change_the_light(
    gpu, commands, owned, monkeypatch, scheme, is_blocked, count
):
    if not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    if scheme == "paper" and count[0] > 8:
        pytest.skip("cuts do not depend on the scheme")
    rng, cells = np.random.default_rng(5), int(np.prod(count))
    states = rng.normal(size=(3, cells, 4)).astype(np.float32)
    injected = owned(buffer_of(gpu, "i", states))
    faces = owned(buffer_of(gpu, "f", rng.integers(0, 1 << 32, cells * 8, dtype=np.uint32)))
    lights = []
    for has_rows in (False, True):
        monkeypatch.setattr(step, "has_row_lanes", lambda _, known=has_rows: known)
        placement = Placement((0.0, 0.0, 0.0), 1.0, count)
        made = owned(
            Propagate(gpu, placement, scheme, is_blocked=is_blocked, is_reflecting=is_blocked)
        )
        total = made.encode(commands, injected, faces, 3)
        commands.submit()
        lights.append(total.read().copy())
    np.testing.assert_allclose(lights[1], lights[0], atol=2e-6 * np.abs(lights[0]).max())


def test_a_tile_reads_two_of_its_cells_at_once_and_none_beside_it():
    text = row_march(Rows.of(32, 4), 8)
    inside = text[text.index("loop {") :]
    assert inside.count("light_at(") == 4 * 4 // 2 + 2 * 4 // 2
    assert inside.count("put(") == 4 * 4 // 2


def test_lanes_at_a_runs_ends_read_what_is_beside_a_long_row():
    text = row_march(Rows.of(70, 4), 8)
    assert text.count("if (lane == 0u && !is_first)") == 4
    assert "if (has_1) { put(" in text
