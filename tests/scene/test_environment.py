"""Environment: maps cleaned of negative light, impossible values refused."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Environment


def test_negative_pixels_give_no_light():
    pixels = np.full((2, 4, 3), -1.0, np.float32)
    pixels[0, 0] = 7.0
    kept = Environment(map=pixels).map
    assert kept.min() == 0.0
    assert kept[0, 0].tolist() == [7.0, 7.0, 7.0]
    assert pixels.min() == -1.0, "the caller's own array stays his"


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"map": np.ones((2, 4), np.float32)}, r"environment map has shape \(2, 4\)"),
        ({"map": np.ones((0, 4, 3), np.float32)}, "environment map has no pixels"),
        ({"map": np.full((1, 1, 3), np.nan)}, "environment map has 3 values that are NaN"),
        ({"radiance": -1}, "environment radiance = .* is negative"),
        ({"scale": -1}, r"environment scale = -1 is outside \[0, 1e\+15\]"),
        ({"visible": "no"}, "environment visible must be true or false"),
    ],
)
def test_impossible_environments_are_refused(values, expected):
    with pytest.raises(SceneError, match=expected):
        Environment(**values)
