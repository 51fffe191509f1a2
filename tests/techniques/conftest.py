"""A small foggy box with a lamp, and a puff of smoke."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene import (
    Camera,
    DirectionalLight,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
    Volume,
)
from airlight.scene.shapes import box, quad

SIZE = (48, 32)
SMALL = {
    "resolution": 12,
    "shadow_resolution": 128,
    "lamp_resolution": 64,
    "sky_lights": 0,
    "surfels": 4000,
}


@pytest.fixture(autouse=True)
def _device(gpu):
    """Every technique needs one."""


def _scaled(side: float) -> np.ndarray:
    return np.diag([side, side, side, 1.0])


@pytest.fixture
def foggy_box() -> Scene:
    """A white box of 4 m, a lamp in the middle, thin fog in all of it, seen from inside."""
    white = Material(base_color=(0.7, 0.7, 0.7), specular=0.0)
    return Scene(
        meshes=(Mesh(box(), white, _scaled(4.0)),),
        lights=(PointLight((0.0, 1.0, 0.0), (5.0, 5.0, 5.0)),),
        camera=Camera((0.0, 0.0, 1.8), (0.0, 0.0, -2.0), fov_y_deg=60.0),
        medium=Medium(sigma_t=(0.2, 0.2, 0.2), albedo=(0.9, 0.9, 0.9)),
    )


@pytest.fixture
def smoke_over_floor() -> Scene:
    """A grey floor under the sun, and a ball of smoke a metre above it."""
    floor = Mesh(quad(), Material(base_color=(0.5, 0.5, 0.5), specular=0.0), _scaled(6.0))
    z, y, x = np.meshgrid(*[np.linspace(-1, 1, n) for n in (10, 12, 14)], indexing="ij")
    density = np.clip(1.5 - 1.6 * np.sqrt(x**2 + y**2 + z**2), 0.0, 1.0).astype(np.float32)
    smoke = Volume((3.0, 3.0, 3.0), density=density, bounds=((-1, 0.5, -1), (1, 2.5, 1)))
    return Scene(
        meshes=(floor,),
        lights=(DirectionalLight((0.0, -1.0, 0.0), (3.0, 3.0, 3.0)),),
        camera=Camera((0.0, 2.5, 5.0), (0.0, 0.8, 0.0), fov_y_deg=50.0),
        volumes=(smoke,),
    )


def small_smoke(scene: Scene) -> Scene:
    """`scene` with each volume in .3 m around its middle: less than two cells of the lattice."""
    made = []
    for volume in scene.volumes:
        middle = np.mean(volume.bounds, axis=0)
        made.append(replace(volume, bounds=(tuple(middle - 0.15), tuple(middle + 0.15))))
    return replace(scene, volumes=tuple(made))
