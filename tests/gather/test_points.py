"""Gather points: how wide they are."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gather.points import pixel_m
from airlight.maths.transforms import clip_from_view_infinite


@pytest.mark.parametrize("near", [0.01, 3.0])
def test_a_pixel_is_as_wide_as_the_points_of_two_are_apart(near):
    world_from_clip = np.linalg.inv(clip_from_view_infinite(0.9, 1.5, near))
    depth = near / 7.0  # of what is 7 m away
    low, high = (world_from_clip @ (0.0, y, depth, 1.0) for y in (0.0, 2.0 / 90))
    apart = np.linalg.norm(high[:3] / high[3] - low[:3] / low[3])
    assert 7.0 * pixel_m(world_from_clip, 90) == pytest.approx(apart)
