"""Lights: unit directions, grey from one number, cones that close."""

from __future__ import annotations

import pytest

from airlight.errors import SceneError
from airlight.scene import DirectionalLight, PointLight, SpotLight


def test_directions_are_normalised_and_grey_is_spread():
    sun = DirectionalLight(direction=(0, 0, -7), irradiance=2)
    assert sun.direction == (0.0, 0.0, -1.0)
    assert sun.irradiance == (2.0, 2.0, 2.0)
    assert PointLight((1, 2, 3), 4).intensity == (4.0, 4.0, 4.0)


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda: DirectionalLight((0, 0, 0), 1), "light direction is zero"),
        (lambda: DirectionalLight((0, -1, 0), -1), r"light irradiance = \[-1\.0.* is negative"),
        (lambda: PointLight((0, 0), 1), "light position must be three numbers"),
        (lambda: PointLight((0, 0, 0), float("inf")), "light intensity is inf"),
        (
            lambda: SpotLight((0, 0, 0), (0, -1, 0), 1, inner_deg=40, outer_deg=30),
            "inner_deg = 40 is above outer_deg = 30",
        ),
        (
            lambda: SpotLight((0, 0, 0), (0, -1, 0), 1, outer_deg=95),
            r"outer_deg = 95 is outside \[0\.1, 89\]",
        ),
    ],
)
def test_impossible_lights_are_refused(make, expected):
    with pytest.raises(SceneError, match=expected):
        make()
