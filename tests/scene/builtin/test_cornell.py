"""The Cornell box: closed on five sides, lit as asked."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import PointLight, SpotLight
from airlight.scene.builtin.cornell import DEPTH_M, HEIGHT_M, WIDTH_M, cornell

from .conftest import make_caster, world_triangles


def test_lights() -> None:
    assert isinstance(cornell().lights[0], SpotLight)
    assert isinstance(cornell(light="point").lights[0], PointLight)
    area = cornell(light="area")
    assert area.lights == ()
    (panel,) = [m for m in area.meshes if m.material.is_emissive]
    # Radiance times area is the spot's intensity on its axis.
    assert np.multiply(panel.material.emission, 1.3 * 1.05) == pytest.approx(
        cornell().lights[0].intensity
    )
    with pytest.raises(SceneError) as told:
        cornell(light="aria")
    assert str(told.value) == "cornell light 'aria' is unknown. Did you mean 'area'?"


def test_open_only_towards_the_camera() -> None:
    cast = make_caster(world_triangles(cornell()))
    rng = np.random.default_rng(0)
    directions = rng.standard_normal((300, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    origin = np.array([0.0, HEIGHT_M * 0.7, 0.0])
    distance = cast(np.tile(origin, (300, 1)), directions)
    scale = (DEPTH_M / 2 + 0.0) / np.maximum(directions[:, 2], 1e-9)
    at_front = origin + scale[:, None] * directions
    through = (
        (directions[:, 2] > 0)
        & (np.abs(at_front[:, 0]) < WIDTH_M / 2)
        & (np.abs(at_front[:, 1] - HEIGHT_M / 2) < HEIGHT_M / 2)
    )
    assert np.all(np.isfinite(distance[~through]))
    assert through.sum() > 20 and np.isinf(distance[through]).mean() > 0.9


def test_red_is_left_and_green_right_as_the_camera_sees_them() -> None:
    walls = {m.name: m for m in cornell().meshes}
    assert walls["left wall"].material.name == "red" and walls["left wall"].world_bounds[1][0] < 0
    assert walls["right wall"].material.name == "green"
    assert all(m.material.specular == 0.0 and m.material.roughness == 1.0 for m in walls.values())
