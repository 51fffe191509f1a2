"""Groups of point lights: what they hold and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

from airlight import PointLights, Scene
from airlight.errors import SceneError

POSITIONS = np.arange(12.0).reshape(4, 3)


def test_arrays_are_kept_as_float32_of_their_own():
    given = POSITIONS.copy()
    group = PointLights(given, np.ones((4, 3)))
    given[:] = 7.0
    assert len(group) == 4
    assert group.positions.dtype == np.float32
    np.testing.assert_array_equal(group.positions, POSITIONS)


def test_one_intensity_holds_for_all():
    group = PointLights(POSITIONS, [[1.0, 2.0, 3.0]])
    assert group.intensities.shape == (4, 3)
    assert group.power == pytest.approx(4 * np.pi * 4 * 3.0)


def test_an_empty_group_has_no_power():
    assert PointLights(np.zeros((0, 3)), np.zeros((0, 3))).power == 0.0


@pytest.mark.parametrize(
    ("positions", "intensities", "message"),
    [
        (np.zeros((4, 2)), np.ones((4, 3)), "positions must be an (N, 3) array, not (4, 2)"),
        ("many", np.ones((4, 3)), "positions must be an (N, 3) array of numbers"),
        (
            POSITIONS,
            np.ones((3, 3)),
            "4 positions, but 3 intensities. Give one row for each light, or one for all.",
        ),
        (POSITIONS, -np.eye(3)[[0, 1, 1, 2]], "intensities: row 0 is negative"),
        (
            np.where(POSITIONS == 7.0, np.nan, POSITIONS),
            np.ones((4, 3)),
            "positions: row 2 is not finite",
        ),
    ],
)
def test_bad_arrays_get_one_exact_message(positions, intensities, message):
    with pytest.raises(SceneError) as error:
        PointLights(positions, intensities)
    assert str(error.value) == message


def test_a_scene_has_none_by_itself():
    assert Scene().light_groups == ()
