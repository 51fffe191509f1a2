"""A closed dark room beside a bright one: gathered light does not come through walls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import Camera, Material, PointLight, Scene

from .panels import X, rectangle

SIZE = (32, 18)
SETTINGS = {"resolution": 16, "lamp_resolution": 256, "map_resolution": 64, "gather": "still"}
PAINT = Material(base_color=(0.8, 0.8, 0.8), specular=0.0)


def rooms(thick: float) -> Scene:
    """Two rooms of 3 x 2 x 3 m side by side, a light in the left one, `thick` m of wall between."""
    low, size = np.array([-3.0, 0.0, -1.5]), np.array([6.0 + thick, 2.0, 3.0])
    x, y, z = size * np.eye(3)
    shell = [(low, z, x), (low + y, x, z), (low, x, y), (low + z, y, x), (low, y, z)]
    walls = [rectangle(*side, PAINT) for side in [*shell, (low + x, z, y)]]
    between = sorted({0.0, thick})
    walls += [rectangle(at * X + low * [0, 1, 1], z, y, PAINT) for at in between]
    return Scene(tuple(walls), (PointLight((-1.5, 1.4, 0.0), (20.0, 20.0, 20.0)),))


# Means and brightest pixels over the bright room's mean light, measured 6.4e-5 and .0010 (what the
# lattice passes a sheet), 5.7e-5 and .0010, then 0; allowed is about half as much again, and 1e-6
# where it is rounding.
MOST = {0.0: (1e-4, 0.0016), 0.001: (9e-5, 0.0016), 0.01: (1e-6, 1e-6), 0.1: (1e-6, 1e-6)}


@pytest.mark.parametrize("thick", [0.0, 0.001, 0.01, pytest.param(0.1, marks=pytest.mark.slow)])
def test_a_dark_room_stays_dark(thick: float) -> None:
    scene = rooms(thick)
    bright = Camera((-2.8, 1.0, 1.2), (0.0, 0.8, -0.6), (0.0, 1.0, 0.0), 70.0)
    dark = Camera((2.8, 1.0, 1.2), (0.0, 0.8, -0.6), (0.0, 1.0, 0.0), 70.0)
    lit, unlit = (
        render(replace(scene, camera=camera), "lpv", SIZE, samples=4, settings=SETTINGS)
        for camera in (bright, dark)
    )
    assert lit.layers["indirect"].mean() > 0.2
    mean, most = MOST[thick]
    assert unlit.radiance.mean() < mean * lit.radiance.mean()
    assert unlit.radiance.max() < most * lit.radiance.mean()


def test_points_on_both_sides_of_a_wall_do_not_share_light_from_afar() -> None:
    """Both floors in one image, from above the rooms without their ceiling.

    What the wall's foot in the dark has beyond the floor half a metre on is .002 of the lit floor's
    mean; it was .035 where light from afar was shared through the wall.
    """
    scene = rooms(0.01)
    open_rooms = tuple(m for m in scene.meshes if m.geometry.positions[:, 1].min() < 1.9)
    above = Camera((0.0, 7.0, 0.01), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 60.0)
    scene = replace(scene, meshes=open_rooms, camera=above)
    light = render(scene, "lpv", (320, 180), samples=2, settings=SETTINGS).layers["indirect"]
    # The wall's top and its dark side, seen from above, cover the columns before.
    foot, floor = light[70:110, 164:170], light[70:110, 190:200]
    assert foot.mean() - floor.mean() < 0.006 * light[70:110, 40:150].mean()
