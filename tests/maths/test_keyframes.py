"""Keyframes: curves pass through them, keep straight lines straight, and turn evenly."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from airlight.maths import keyframes

TIMES = np.array([0.0, 0.5, 2.0, 2.25, 4.0])
VALUES = np.random.default_rng(3).normal(size=(5, 3))


@pytest.mark.parametrize("curve", [keyframes.step, keyframes.linear, keyframes.smooth])
def test_curves_pass_through_their_keyframes_and_hold_outside(curve):
    for time, value in zip(TIMES, VALUES, strict=True):
        np.testing.assert_allclose(curve(TIMES, VALUES, time), value, atol=1e-12)
    np.testing.assert_allclose(curve(TIMES, VALUES, -3.0), VALUES[0])
    np.testing.assert_allclose(curve(TIMES, VALUES, 9.0), VALUES[-1])
    np.testing.assert_allclose(curve(TIMES[:1], VALUES[:1], 0.3), VALUES[0])


def test_a_step_holds_until_the_next():
    np.testing.assert_array_equal(keyframes.step(TIMES, VALUES, 1.999), VALUES[1])


def test_even_motion_stays_even_at_uneven_times():
    even = np.outer(TIMES, (1.0, -2.0, 0.5)) + 3.0
    for time in np.linspace(0.0, 4.0, 23):
        np.testing.assert_allclose(
            keyframes.smooth(TIMES, even, time),
            even[0] + time * np.array((1.0, -2.0, 0.5)),
            atol=1e-12,
        )


def test_smooth_curves_are_the_known_ones_and_have_no_kinks():
    t = TIMES
    speeds = [(VALUES[1] - VALUES[0]) / (t[1] - t[0])]
    for k in range(1, 4):  # of the parabola through three points
        parabola = np.polyfit(t[k - 1 : k + 2] - t[k], VALUES[k - 1 : k + 2], 2)
        speeds.append(parabola[1])
    speeds.append((VALUES[4] - VALUES[3]) / (t[4] - t[3]))
    known = CubicHermiteSpline(t, VALUES, np.array(speeds))
    for time in np.linspace(0.01, 3.99, 50):
        np.testing.assert_allclose(keyframes.smooth(t, VALUES, time), known(time), atol=1e-9)


def test_rotations_turn_evenly_along_the_shorter_way():
    turns = Rotation.from_euler(
        "xyz", [(0, 0, 0), (90, 0, 0), (90, 40, 10), (0, 170, 0)], degrees=True
    )
    quaternions = turns.as_quat()
    quaternions[2] *= -1.0  # the same rotation
    known = Slerp(TIMES[:4], turns)
    for time in np.linspace(0.0, 2.25, 31):
        ours = Rotation.from_quat(keyframes.slerp(TIMES[:4], quaternions, time))
        assert (ours * known(time).inv()).magnitude() < 1e-7


def test_cubic_splines_have_the_tangents_given():
    values = np.random.default_rng(4).normal(size=(5, 3, 2))
    a, b = values[1], values[2]
    known = CubicHermiteSpline([0.5, 2.0], [a[1], b[1]], [a[2], b[0]])
    for time in (0.5, 0.9, 1.7):
        np.testing.assert_allclose(keyframes.cubic_spline(TIMES, values, time), known(time))
    np.testing.assert_array_equal(keyframes.cubic_spline(TIMES, values, 7.0), values[-1, 1])


def test_nothing_turns_nothing():
    np.testing.assert_array_equal(keyframes.unit_quaternion(np.zeros(4)), [0, 0, 0, 1])
