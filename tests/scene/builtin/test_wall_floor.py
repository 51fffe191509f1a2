"""The wall is uniformly bright and the floor gets no light but its own."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.builtin.wall_floor import ALBEDO, wall_floor


def test_light_meets_the_wall_head_on_and_grazes_the_floor() -> None:
    scene = wall_floor(cells=10, cell_m=0.5)
    (sun,) = scene.lights
    wall, floor = scene.meshes
    assert np.allclose(wall.geometry.normals @ np.array(sun.direction), -1.0)
    assert np.allclose(floor.geometry.normals @ np.array(sun.direction), 0.0)
    radiance = np.array(sun.irradiance) * ALBEDO / np.pi
    assert radiance == pytest.approx([ALBEDO] * 3)
    assert np.allclose(wall.world_bounds, [(-2.5, 0, 0), (2.5, 5, 0)])
    assert np.allclose(floor.world_bounds, [(-2.5, 0, 0), (2.5, 0, 5)])


def test_impossible_sizes() -> None:
    with pytest.raises(SceneError, match="cells = 0 is outside"):
        wall_floor(cells=0)
