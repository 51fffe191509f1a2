"""A wall between two media: what one scatters does not come through it, and not less without it."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import Camera, Material, Mesh, Scene, Volume
from airlight.scene.lights import DirectionalLight
from airlight.scene.shapes import quad

SETTINGS = {
    "grid": 8,
    "ordinates": 1,
    "solver_steps": 24,
    "resolution": 16,
    "surfels": 4000,
    "shadow_resolution": 64,
    "sky_lights": 0,
}
BOXES = (((-1.25, -0.5, -0.5), (-0.25, 0.5, 0.5)), ((0.25, -0.5, -0.5), (1.25, 0.5, 0.5)))
CAMERA = Camera((0.0, 1.0, 4.5), (0.0, 0.0, 0.0), fov_y_deg=36.0)


def black(corner: object, u: object, v: object) -> Mesh:
    """A black rectangle of edges u and v."""
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 2] = u, v
    normal = np.cross(matrix[:3, 2], matrix[:3, 0])
    matrix[:3, 1] = normal / np.linalg.norm(normal)
    matrix[:3, 3] = np.asarray(corner) + 0.5 * (matrix[:3, 0] + matrix[:3, 2])
    return Mesh(quad(), Material(base_color=(0.0,) * 3, specular=0.0), matrix)


def light_of_the_second(technique: str, half: float) -> float:
    """Of two boxes, the second under a roof: lit by the first alone, past a wall 2 half wide."""
    meshes = [
        black((-2, -1.2, -2), (4, 0, 0), (0, 0, 4)),
        black((0.02, 1.3, -2), (2, 0, 0), (0, 0, 4)),
    ]
    if half:
        meshes.append(black((0, -half, -half), (0, 0, 2 * half), (0, 2 * half, 0)))
    scene = Scene(
        meshes=tuple(meshes),
        lights=(DirectionalLight((0.0, -1.0, 0.0), (3.0,) * 3),),
        volumes=tuple(Volume((4.0,) * 3, np.ones((4, 4, 4), np.float32), bounds=b) for b in BOXES),
        environment=None,
        camera=CAMERA,
    )
    image = render(scene, technique, (24, 16), settings=SETTINGS, samples=1)
    return float(image.radiance[:, 12:].mean())


@pytest.mark.parametrize("technique", ["auto", pytest.param("pop", marks=pytest.mark.slow)])
def test_a_wall_stops_what_media_give_one_another(technique: str) -> None:
    """A path tracer has nothing behind a wall of 1.8 m either."""
    free = light_of_the_second(technique, 0.0)
    assert free > 1e-4
    assert light_of_the_second(technique, 0.9) < 1e-3 * free
