"""Light that comes into a lattice from endless air around it."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer
from airlight.lattice.placement import Placement
from airlight.maths.plane_air import plane_light
from airlight.scatter.inject_border import InjectBorder, incoming_light
from airlight.scene import DirectionalLight, Medium

PLACE = Placement((-3.0, 0.0, -2.0), 1.0, (6, 8, 4))
SUN = DirectionalLight((0.0, -1.0, 0.0), (4.0, 2.0, 1.0))
AIR = Medium(0.2, (0.9, 0.8, 0.0), endless=True)


def test_layers_take_what_the_half_space_sends():
    rows = incoming_light(PLACE, AIR, 10.0, [SUN])
    light = plane_light(0.9, np.array([1.0]), np.array([4.0]))
    assert rows[2, 0] == pytest.approx(np.interp(0.2 * 7.5, light.depth, light.side))
    assert rows[-1, 0] == pytest.approx(np.interp(0.2 * 2.0, light.depth, light.down))
    assert (rows[:, 2] == 0.0).all()  # nothing scatters, nothing comes in scattered
    low = incoming_light(PLACE, AIR, 5.0, [SUN])
    assert (low[5:] == 0.0).all() and (low[:5, 0] > 0.0).all()


def test_every_open_side_brings_its_share(gpu, commands, owned):
    cells = owned(Buffer(gpu, "cells", 3 * PLACE.cells * 16))
    cells.write(np.zeros((3 * PLACE.cells, 4), np.float32))
    border = owned(InjectBorder(gpu, PLACE))
    border.encode(commands, cells, AIR, 10.0, [SUN])
    commands.submit()
    made = np.frombuffer(cells.read(), np.float32).reshape(3, 4, 8, 6, 4).astype(np.float64)
    rows = incoming_light(PLACE, AIR, 10.0, [SUN])
    around, lid = 2 * (6 + 4), 6 * 4
    total = around * rows[:-1, :3].sum(axis=0) + lid * rows[-1, :3]
    np.testing.assert_allclose(made[..., 0].sum(axis=(1, 2, 3)), total, rtol=1e-5)
    assert (made[:, 1:-1, :-1, 1:-1] == 0.0).all()  # inside, and the bottom
    # The middle of the low x side: all of it inwards, two thirds of it along.
    a, bx, by, bz = made[0, 1, 3, 0]
    np.testing.assert_allclose((bx, by, bz), (2.0 / 3.0 * a, 0.0, 0.0), atol=1e-6)
    np.testing.assert_allclose(made[..., 1].sum(), 0.0, atol=1e-4)
