"""Matrices between spaces, against what they are to do to points."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import transforms as t

RNG = np.random.default_rng(7)


def test_unit_keeps_the_direction():
    np.testing.assert_allclose(t.unit([3.0, 0.0, 4.0]), [0.6, 0.0, 0.8])


@pytest.mark.parametrize(
    "forward", [(0, 0, -1), (1, 0, 0), (0.3, -0.5, 0.8), (0, 1, 0), (0, -2, 0)]
)
def test_the_view_looks_down_minus_z(forward):
    eye = np.array([1.0, -2.0, 3.0])
    m = t.view_from_world(eye, forward, (0, 1, 0))
    np.testing.assert_allclose(m[:3, :3] @ m[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(m[:3, :3]) == pytest.approx(1.0)
    ahead = t.transformed((eye + 2.0 * t.unit(forward))[None], m)
    np.testing.assert_allclose(ahead, [[0.0, 0.0, -2.0]], atol=1e-12)
    np.testing.assert_allclose(t.transformed(eye[None], m), 0.0, atol=1e-12)


def test_up_is_up_and_right_is_right():
    m = t.view_from_world((0, 0, 0), (0, -0.4, -1), (0, 1, 0))
    x, y = m @ [1.0, 0.0, 0.0, 0.0], m @ [0.0, 1.0, 0.0, 0.0]
    assert x[0] == pytest.approx(1.0)
    assert y[1] > 0.9
    assert y[0] == pytest.approx(0.0)


def test_infinite_perspective_reverses_depth():
    fov, aspect, near = 1.1, 1.5, 0.25
    m = t.clip_from_view_infinite(fov, aspect, near)
    z = np.array([0.25, 1.0, 10.0, 1e6])
    points = np.stack([np.zeros(4), np.zeros(4), -z], axis=1)
    np.testing.assert_allclose(t.transformed(points, m)[:, 2], near / z)
    # the image's corner is where the field of view ends
    y = np.tan(fov / 2.0) * 3.0
    corner = t.transformed(np.array([[aspect * y, y, -3.0]]), m)
    np.testing.assert_allclose(corner[0, :2], [1.0, 1.0])


def test_square_perspective_has_conventional_depth():
    m = t.clip_from_view_perspective(np.pi / 2, 0.5, 20.0)
    points = np.array([[0, 0, -0.5], [0, 0, -20.0], [3.0, -3.0, -3.0]])
    ndc = t.transformed(points, m)
    np.testing.assert_allclose(ndc[:2, 2], [0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(ndc[2, :2], [1.0, -1.0])


def test_orthographic_maps_the_box_to_the_clip_box():
    low, high = np.array([-1.0, 2.0, -9.0]), np.array([3.0, 5.0, -4.0])
    ndc = t.transformed(np.array([low, high]), t.clip_from_view_orthographic(low, high))
    np.testing.assert_allclose(ndc, [[-1, -1, 1], [1, 1, 0]], atol=1e-12)


def test_jitter_moves_the_image_by_pixels():
    clip = t.clip_from_view_infinite(1.0, 2.0, 0.1)
    points = np.stack([*RNG.normal(size=(2, 20)), -RNG.uniform(1, 9, 20)], axis=1)
    size = (64, 32)

    def pixels(m):
        ndc = t.transformed(points, m)
        return np.stack([(ndc[:, 0] + 1) * 32, (1 - ndc[:, 1]) * 16], axis=1)

    moved = pixels(t.jittered(clip, (0.3, -0.2), size)) - pixels(clip)
    np.testing.assert_allclose(moved, np.tile([0.3, -0.2], (20, 1)), atol=1e-9)


def test_box_corners_are_all_eight():
    corners = t.box_corners((0, 1, 2), (3, 4, 5))
    assert {tuple(c) for c in corners} == {
        (x, y, z) for x in (0, 3) for y in (1, 4) for z in (2, 5)
    }
