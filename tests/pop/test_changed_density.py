"""Grids replaced or scaled between frames: all that was made of the old density is made again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Environment, Material, Scene
from airlight.scene.volume import Volume

SIZE = (12, 8)
SMALL = {"sky_lights": 8, "sky_resolution": 16, "surfels": 2000, "grid": 8}
OLD, NEW = np.random.default_rng(1).uniform(0.2, 1.0, (2, 6, 5, 6)).astype(np.float32)


def placed(i: int) -> Volume:
    """The i-th of some boxes of the old density, half a kilometre wide."""
    to_world = np.diag([250.0, 200.0, 250.0, 1.0])
    to_world[:3, 3] = 400.0 * i, 300.0, 0.0
    return Volume((0.01,) * 3, OLD, albedo=(0.9,) * 3, g=(0.6,) * 3, world_from_volume=to_world)


def scene(square: Any, volumes: tuple[Volume, ...]) -> Scene:
    """Over a floor, in directional light and a sky."""
    return Scene(
        meshes=(square((0, 0, 0), (0, 0, 1500), (1500, 0, 0), Material((0.3, 0.3, 0.3))),),
        volumes=volumes,
        lights=(DirectionalLight((0.5, -0.7, 0.3), (6.0, 5.5, 5.0)),),
        environment=Environment(radiance=(0.3, 0.5, 0.8)),
        camera=Camera(position=(0.0, 400.0, 1500.0), target=(0.0, 300.0, 0.0)),
    )


CHANGES: dict[str, Callable[[Volume], Volume]] = {
    "replaced": lambda v: replace(v, density=NEW),
    "scaled": lambda v: replace(v, density=0.5 * OLD),
    "extinction": lambda v: replace(v, sigma_t=(0.02,) * 3),
}


@pytest.mark.parametrize(("count", "settings"), [(1, {}), (1, {"grid_levels": 2}), (5, {})])
def test_another_density_is_that_of_a_renderer_made_with_it(
    square: Any, count: int, settings: dict[str, Any]
) -> None:
    old = tuple(placed(i) for i in range(count))
    settings = SMALL | settings
    with Renderer(scene(square, old), "pop", SIZE, settings=settings) as changed:
        changed.frame()
        for name, change in CHANGES.items():
            new = scene(square, (change(old[0]), *old[1:]))
            got = changed.frame(volumes=new.volumes).radiance
            with Renderer(new, "pop", SIZE, settings=settings) as made:
                np.testing.assert_array_equal(got, made.frame().radiance, err_msg=name)
