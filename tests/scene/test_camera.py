"""Camera: what it accepts, and the degenerate cases it mends or refuses."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Camera
from airlight.scene.camera import view_directions


def test_up_is_normalised():
    assert Camera(up=(0, 5, 0)).up == (0.0, 1.0, 0.0)


@pytest.mark.parametrize("target", [(0, 9, 0), (0, -9, 0)])
def test_looking_along_up_takes_another_up(target):
    assert Camera(position=(0, 0, 0), target=target).up == (0.0, 0.0, -1.0)


def test_looking_along_a_level_up_takes_the_vertical():
    assert Camera(position=(0, 0, 0), target=(3, 0, 0), up=(1, 0, 0)).up == (0.0, 1.0, 0.0)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"position": (1, 2, 3), "target": (1, 2, 3)}, "camera position and target are the same"),
        ({"up": (0, 0, 0)}, "camera up is zero"),
        ({"fov_y_deg": 0}, r"fov_y_deg = 0 is outside \[0\.1, 179\]"),
        ({"position": (0, float("nan"), 0)}, "camera position is nan"),
    ],
)
def test_a_camera_that_sees_nothing_is_refused(values, expected):
    with pytest.raises(SceneError, match=expected):
        Camera(**values)


def test_view_directions_span_the_field_of_view():
    camera = Camera(position=(0, 0, 0), target=(0, 0, -1), fov_y_deg=90)
    directions = view_directions(camera, 2, 2, aspect=1)
    expected = np.array([(-1, 1, -2), (1, 1, -2), (-1, -1, -2), (1, -1, -2)]) / 6**0.5
    np.testing.assert_allclose(directions, expected, atol=1e-12)
