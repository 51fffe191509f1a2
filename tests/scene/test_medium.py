"""Medium: the two ways of giving coefficients agree; impossible ones are refused."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Medium
from airlight.scene.medium import extinction_and_albedo, medium_box


def test_scattering_and_absorption_come_back():
    sigma_t, albedo = extinction_and_albedo((3.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    medium = Medium(sigma_t=sigma_t, albedo=albedo)
    np.testing.assert_allclose(medium.sigma_t, (4.0, 1.0, 0.0))
    np.testing.assert_allclose(medium.albedo, (0.75, 1.0, 0.0))
    np.testing.assert_allclose(medium.sigma_s, (3.0, 1.0, 0.0))
    np.testing.assert_allclose(medium.sigma_a, (1.0, 0.0, 0.0))


def test_one_number_is_grey_and_the_default_is_white_and_isotropic():
    medium = Medium(sigma_t=2, g=-0.5)
    assert medium.sigma_t == (2.0, 2.0, 2.0)
    assert medium.g == (-0.5, -0.5, -0.5)
    assert Medium(sigma_t=1).albedo == (1.0, 1.0, 1.0)
    assert Medium(sigma_t=1).g == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"sigma_t": -1}, r"sigma_t = \[-1\.0, -1\.0, -1\.0\] is negative"),
        ({"sigma_t": 1, "albedo": 1.5}, r"albedo = \[1\.5, 1\.5, 1\.5\] is above 1"),
        ({"sigma_t": 1, "g": 1}, r"g = \[1\.0, 1\.0, 1\.0\] must lie in \(-1, 1\)"),
        ({"sigma_t": 1, "g": (0, -1, 0)}, r"must lie in \(-1, 1\)"),
        ({"sigma_t": 1, "g": True}, "g must be three numbers, not True"),
        ({"sigma_t": 1, "bounds": ((0, 0, 0), (0, 1, 1))}, "medium bounds is empty"),
    ],
)
def test_impossible_media_are_refused(values, expected):
    with pytest.raises(SceneError, match=expected):
        Medium(**values)


LOW, HIGH, EYE = np.array([-5.0, 0.0, -5.0]), np.array([5.0, 8.0, 5.0]), (0.0, 2.0, 20.0)


def test_an_endless_medium_has_a_top_and_no_other_end():
    low, high = medium_box(Medium(0.05, endless=True), LOW, HIGH, EYE)
    assert high[1] == pytest.approx(10.0)  # the scene's height and a quarter of it
    # From the eye, a millionth of the light comes through to any other side.
    for distance in (
        low[0] - EYE[0],
        high[0] - EYE[0],
        low[2] - EYE[2],
        high[2] - EYE[2],
        low[1] - 2.0,
    ):
        assert np.exp(-0.05 * abs(distance)) < 1e-6
    assert medium_box(Medium(0.05, endless=True, top=3.0), LOW, HIGH, EYE)[1][1] == 3.0


def test_air_that_fills_the_scene_holds_the_eye():
    low, high = medium_box(Medium(0.05), LOW, HIGH, EYE)
    assert (low < LOW).all() and (high > np.maximum(HIGH, EYE)).all() and high[1] < 8.1


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"top": 3.0}, "only an endless medium has a top. Add endless = true."),
        (
            {"endless": True, "bounds": ((0, 0, 0), (1, 1, 1))},
            "an endless medium has no bounds. Give its top alone.",
        ),
    ],
)
def test_ends_that_contradict_each_other_are_refused(values, message):
    with pytest.raises(SceneError) as caught:
        Medium(0.1, **values)
    assert str(caught.value) == message


def test_from_above_the_horizon_is_a_straight_line():
    eye = np.array([0.0, 25.0, 0.0])  # 15 m above the top: the box's sides and corners look alike
    low, high = medium_box(Medium(0.05, endless=True), LOW, HIGH, eye)
    assert np.degrees(15.0 / (high[0] - eye[0])) < 0.04
    moved = medium_box(Medium(0.05, endless=True), LOW, HIGH, np.add(eye, (0.3, 0.2, -0.4)))
    np.testing.assert_array_equal(moved, (low, high))
