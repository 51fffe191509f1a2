"""The boxes within which the solvers of volumes know the walls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.pop.medium.kinds import grid_plan
from airlight.pop.medium.known_walls import known_walls
from airlight.pop.settings import PopSettings
from airlight.scene import Volume

SETTINGS = PopSettings(grid=10)
BOX = Volume((1.0,) * 3, shape="box", bounds=((0, 0, 0), (1, 1, 1)))


def inside(boxes, point):
    found = [(box @ (*point, 1.0))[:3] for box in boxes]
    return any((uvw >= 0.0).all() and (uvw <= 1.0).all() for uvw in found)


def test_walls_are_known_as_far_as_the_middle_of_a_next_cell():
    boxes = known_walls([BOX], grid_plan([BOX], SETTINGS), SETTINGS, 0.02)
    for axis in range(3):
        for off, is_known in ((-0.069, True), (-0.071, False), (1.069, True), (1.071, False)):
            point = [0.5] * 3
            point[axis] = off
            assert inside(boxes, point) is is_known


@pytest.mark.parametrize("count", [3, 12])
def test_many_volumes_know_what_stands_in_their_common_box(count):
    volumes = [replace(BOX, bounds=((2 * k, 0, 0), (2 * k + 1, 1, 1))) for k in range(count)]
    boxes = known_walls(volumes, grid_plan(volumes, SETTINGS), SETTINGS, 0.0)
    assert len(boxes) == (3 if count == 3 else 1)
    assert inside(boxes, (1.5, 0.5, 0.5)) is (count == 12)


def test_hops_know_no_walls():
    hops = PopSettings(scheme="split")
    assert known_walls([BOX], grid_plan([BOX], hops), hops, 1.0) == []
    assert np.allclose(
        known_walls([BOX], grid_plan([BOX], SETTINGS), SETTINGS, 0.0)[0][3], (0, 0, 0, 1)
    )
