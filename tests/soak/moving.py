"""A scene in which everything moves: camera, lights, sky, transforms, vertices, densities."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Geometry,
    Material,
    Mesh,
    PointLight,
    Scene,
    Volume,
)

GREY = Material(base_color=(0.6, 0.6, 0.6), specular=0.0)
CELLS = 8
SMOKE = (6, 8, 6)
SURFACES = {
    "resolution": 12,
    "shadow_resolution": 128,
    "sky_lights": 12,
    "sky_resolution": 16,
    "surfels": 4_000,
}
LATTICE = {**SURFACES, "map_resolution": 32}
SETTINGS: dict[str, dict[str, Any]] = {
    "direct": SURFACES,
    "single": SURFACES,
    "lpv": {**LATTICE, "iterations": 8},
    "lpv-march": {**LATTICE, "iterations": 8},
    "lpv-sum": {**LATTICE, "iterations": 8},
    "lpv-scatter": {**LATTICE, "iterations": 4},
    "pop": {**SURFACES, "ordinates": 8, "grid": 6, "solver_steps": 6},
    "auto": SURFACES,
}
"""Small, so that a frame is mostly what may leak and not what computes."""


def scene() -> Scene:
    """The first frame's."""
    return Scene(**moved(0), name="soak")


def moved(step: int) -> dict[str, Any]:
    """What `Renderer.frame` is given for frame number `step`."""
    turn = 0.05 * step
    c, s = math.cos(turn), math.sin(turn)
    sky = np.zeros((8, 16, 3), np.float32)
    sky[:4, step % 16] = 4.0
    return {
        "camera": Camera((4.0 * s, 1.5, 4.0 * c), (0.0, 0.7, 0.0)),
        "lights": (
            DirectionalLight((0.4 * c, -1.0, 0.4 * s), (6.0, 6.0, 6.0)),
            PointLight((s, 2.0, c), (3.0, 2.0, 1.0)),
        ),
        "environment": Environment(map=sky, rotation_deg=float(step % 360)),
        "meshes": (_FLOOR, _turned_box(turn), _sheet(turn)),
        "volumes": (
            Volume((2.0, 2.0, 2.0), density=_drifting(turn), bounds=((-1, 0.9, -1), (1, 2.5, 1))),
        ),
    }


def _floor() -> Mesh:
    corners = np.array([(-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2)], np.float32)
    return Mesh(Geometry(corners, np.array([(0, 1, 2), (0, 2, 3)], np.uint32)), GREY)


_FLOOR = _floor()


def _turned_box(turn: float) -> Mesh:
    """A wall that turns about +Y: the same vertices in another place."""
    matrix = np.eye(4)
    c, s = math.cos(turn), math.sin(turn)
    matrix[:3, :3] = (c, 0, s), (0, 1, 0), (-s, 0, c)
    matrix[:3, 3] = 0.5 * c, 0.6, 0.5 * s
    return Mesh(_WALL, GREY, matrix)


_WALL = Geometry(
    np.array([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)], np.float32),
    np.array([(0, 1, 2), (0, 2, 3), (2, 1, 0), (3, 2, 0)], np.uint32),
)


def _sheet(turn: float) -> Mesh:
    """A sheet in waves: other vertices in every frame."""
    x, z = np.meshgrid(np.linspace(-1, 1, CELLS + 1), np.linspace(-1, 1, CELLS + 1))
    y = 0.3 + 0.1 * np.sin(3.0 * x + turn)
    positions = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(np.float32)
    k, n = (np.arange(CELLS)[:, None] * (CELLS + 1) + np.arange(CELLS)).ravel(), CELLS + 1
    triangles = np.concatenate([[k, k + n, k + 1], [k + 1, k + n, k + n + 1]], axis=1).T
    return Mesh(Geometry(positions, triangles.astype(np.uint32)), GREY)


def _drifting(turn: float) -> np.ndarray:
    """Densities (z, y, x) of a cloud that rises and sinks."""
    y = np.linspace(0.0, 1.0, SMOKE[1], dtype=np.float32)[None, :, None]
    ball = np.exp(-20.0 * (y - 0.5 - 0.3 * np.float32(math.sin(turn))) ** 2)
    return np.ascontiguousarray(np.broadcast_to(ball, SMOKE))
