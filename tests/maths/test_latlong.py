"""Orientation of environment maps as DESIGN and Mitsuba have it."""

import numpy as np

from airlight.maths import latlong


def test_known_directions() -> None:
    d = [[0, 1, 0], [0, 0, -1], [1, 0, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    uv = latlong.latlong_from_direction(d)
    np.testing.assert_allclose(uv[:, 1], [0, 0.5, 0.5, 0.5, 0.5, 1], atol=1e-15)
    np.testing.assert_allclose(uv[1:5, 0], [0, 0.25, 0.5, 0.75], atol=1e-15)


def test_round_trip() -> None:
    uv = np.random.default_rng(1).random((1000, 2))
    back = latlong.latlong_from_direction(latlong.direction_from_latlong(uv))
    np.testing.assert_allclose(back, uv, atol=1e-12)


def test_texels_cover_the_sphere_evenly() -> None:
    rows = latlong.latlong_row_solid_angles(24, 48)
    np.testing.assert_allclose(rows.sum() * 48, 4.0 * np.pi)
    d = latlong.latlong_texel_directions(24, 48)
    assert d.shape == (24, 48, 3)
    np.testing.assert_allclose(np.einsum("h,hwi->i", rows, d), 0.0, atol=1e-12)
