"""Rays that are guided to what lights shine on."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import Camera, Material, Mesh, PointLight, Scene, SpotLight
from airlight.scene.shapes import box

SIZE = (48, 32)
LPV = {"resolution": 8, "lamp_resolution": 128, "map_resolution": 64, "iterations": 16}
ROOM = Mesh(box(), Material(base_color=(0.5,) * 3, specular=0.0), np.diag((4.0, 4.0, 4.0, 1.0)))
EYE = Camera((0.0, 0.0, 1.9), (0.0, -0.5, -2.0), fov_y_deg=60.0)
SPOT = SpotLight((0.0, 1.5, 0.0), (-1.0, 0.0, 0.0), (2000.0,) * 3, 1.6, 2.2)


def indirect(light, samples, guided):
    settings = {**LPV, "gather_guided": guided}
    return render(
        Scene((ROOM,), (light,), camera=EYE), "lpv", SIZE, samples=samples, settings=settings
    ).layers["indirect"]


def test_a_small_lit_patch_is_not_found_by_luck():
    """A spot of .15 m on the wall of a room of 4 m is all that lights it."""
    truth, found = indirect(SPOT, 32, 2), indirect(SPOT, 2, 2)
    by_luck = indirect(SPOT, 2, 0)
    cap = np.percentile(truth, 99)
    off, far_off = (
        np.linalg.norm(np.minimum(image, cap) - np.minimum(truth, cap)) / np.linalg.norm(truth)
        for image in (found, by_luck)
    )
    assert off < 0.1
    assert off < 0.3 * far_off


def test_guided_rays_bring_no_more_light_than_others():
    """The means of a spot large enough that rays by the cosine converge are the same."""
    wide = SpotLight((0.0, 1.5, 0.0), (-1.0, -0.5, 0.0), (100.0,) * 3, 12.0, 14.0)
    with_guide, without = (indirect(wide, 32, guided).mean() for guided in (4, 0))
    assert with_guide == pytest.approx(without, rel=0.01)


def test_where_light_is_wide_nothing_is_guided():
    """A point light in the middle lights all walls: the image is the same to the bit."""
    light = PointLight((0.0, 0.0, 0.0), (10.0,) * 3)
    np.testing.assert_array_equal(indirect(light, 1, 2), indirect(light, 1, 0))
