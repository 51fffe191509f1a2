"""Medium: the two ways of giving coefficients agree; impossible ones are refused."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Medium
from airlight.scene.medium import extinction_and_albedo


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
