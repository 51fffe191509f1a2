"""Ordinates drawn to what is seen: light is kept, and they move as smoothly as the view."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from airlight.maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from airlight.maths.ordinates import partition, uniform_sky
from airlight.maths.phase import henyey_greenstein
from airlight.maths.view_ordinates import resized, view_partition, view_samples

TOWARDS = latlong_texel_directions(48, 96)
COARSE = latlong_texel_directions(16, 32)
WINDOW = TOWARDS @ np.array([0.6, 0.2, -np.sqrt(0.6)]) > 0.985
MAP = (0.4 + 30.0 * WINDOW[..., None]) * np.array([1.0, 0.8, 0.6])


def seen_from(angle: float) -> np.ndarray:
    axis = np.array([np.sin(angle), 0.0, -np.cos(angle)])
    return 4.0 * np.pi * henyey_greenstein(COARSE @ axis, 0.7)


def test_all_light_is_kept():
    made = view_partition(MAP, 24, seen_from(0.3))
    omega = latlong_row_solid_angles(48, 96)[:, None, None]
    np.testing.assert_allclose(made.irradiance.sum(axis=0), (MAP * omega).sum(axis=(0, 1)))
    assert made.solid_angle.sum() == pytest.approx(4.0 * np.pi)
    np.testing.assert_allclose(np.linalg.norm(made.direction, axis=1), 1.0)
    assert np.all((made.mean_cosine > 0.2) & (made.mean_cosine <= 1.0))


def test_more_ordinates_are_where_more_is_seen():
    axis = np.array([0.0, 0.0, -1.0])
    near = [
        int((-made.direction @ axis > 0.7).sum())
        for made in (partition(MAP, 40), view_partition(MAP, 40, seen_from(0.0)))
    ]
    assert near[1] >= near[0] + 2


def test_an_even_view_of_an_uniform_sky_is_the_uniform_sky():
    made, even = view_partition(np.ones((48, 96, 3)), 32, np.ones((16, 32))), uniform_sky(32)
    np.testing.assert_allclose(made.direction, even.direction, atol=0.06)
    np.testing.assert_allclose(made.irradiance, even.irradiance, rtol=0.15)


def test_ordinates_move_as_smoothly_as_the_view():
    """Half the turn, half the change: of directions, and of the light that each carries."""
    for value in ("direction", "irradiance"):
        rows = [
            getattr(view_partition(MAP, 32, seen_from(0.3 + 2e-3 * k)), value) for k in range(7)
        ]
        scale = np.abs(rows[0]).max()
        one = [np.abs(b - a).max() / scale for a, b in pairwise(rows)]
        two = [np.abs(b - a).max() / scale for a, b in zip(rows[:-2], rows[2:], strict=True)]
        assert max(one) < 0.02
        assert max(one) < 0.75 * max(two)


def test_samples_follow_the_product():
    plain, seen = (view_samples(MAP, 60, w) for w in (np.ones((16, 32)), seen_from(np.pi)))
    towards = np.array([0.0, 0.0, 1.0])
    count = [int((-made.direction @ towards > 0.7).sum()) for made in (plain, seen)]
    assert count[1] > count[0] + 10
    total = [made.irradiance[:, 0].sum() for made in (plain, seen)]
    assert total[1] == pytest.approx(total[0], rel=0.35)  # a weighted sum of samples


def test_a_map_resized_has_a_mean_of_one():
    big = resized(3.0 * seen_from(0.4), (48, 96))
    omega = latlong_row_solid_angles(48, 96)[:, None]
    assert (big * omega).sum() == pytest.approx(4.0 * np.pi)
    want = resized(seen_from(0.4), (16, 32))
    np.testing.assert_allclose(want, seen_from(0.4), rtol=0.02)
