"""The failure cases fail as they are meant to: sizes against a cell, and one iteration."""

from __future__ import annotations

import numpy as np

from airlight.lattice.placement import fitted
from airlight.scene.builtin.failures import BOARD_M, bleeding, one_iteration, pinpoint


def test_the_board_and_the_spot_are_smaller_than_a_cell() -> None:
    cell_m = fitted(*bleeding().bounds, 32).cell
    assert cell_m > 10.0 * BOARD_M
    (light,) = pinpoint().lights
    reach_m = np.linalg.norm(np.subtract(light.position, (0.0, 1.5, 0.0)))
    assert 2.0 * reach_m * np.tan(np.radians(light.outer_deg)) < cell_m


def test_the_eye_is_behind_the_board_or_before_it() -> None:
    assert bleeding().camera.position[0] > 0.0 > bleeding().lights[0].position[0]
    assert pinpoint().camera.position[0] < 0.0


def test_one_iteration_is_a_setting_of_the_scene() -> None:
    assert one_iteration().settings["lpv-scatter"]["iterations"] == 1
