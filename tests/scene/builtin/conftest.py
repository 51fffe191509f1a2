"""A brute-force ray caster, independent of the package, and the scenes that are dear to build."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from airlight.scene import Scene
from airlight.scene.builtin import builtin_scene

Caster = Callable[[np.ndarray, np.ndarray], np.ndarray]


def world_triangles(scene: Scene, without: tuple[str, ...] = ()) -> np.ndarray:
    """All triangles (T, 3, 3) in the world, less the meshes whose name holds one of `without`."""
    parts = []
    for mesh in scene.meshes:
        if any(word in mesh.name for word in without):
            continue
        matrix = mesh.world_from_object
        points = mesh.geometry.positions @ matrix[:3, :3].T + matrix[:3, 3]
        parts.append(points[mesh.geometry.indices])
    return np.concatenate(parts)


def make_caster(triangles: np.ndarray) -> Caster:
    """Distance (N,) to the first triangle along each ray; infinite where none is hit.

    Moeller1997, all triangles against each ray.
    """
    middle = triangles.mean(axis=1)
    reach2 = np.square(triangles - middle[:, None]).sum(axis=2).max(axis=1) * 1.01 + 1e-9

    def one(origin: np.ndarray, direction: np.ndarray) -> float:
        away = middle - origin
        along = away @ direction
        near = np.einsum("ij,ij->i", away, away) - along * along <= reach2
        a, b, c = (triangles[near, k] for k in range(3))
        e1, e2, s = b - a, c - a, origin - a
        p, q = np.cross(direction, e2), np.cross(s, e1)
        det = np.einsum("ij,ij->i", e1, p)
        inverse = 1.0 / np.where(np.abs(det) < 1e-14, np.inf, det)
        u = np.einsum("ij,ij->i", s, p) * inverse
        v = q @ direction * inverse
        t = np.einsum("ij,ij->i", e2, q) * inverse
        inside = (inverse != 0) & (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 1e-6)
        return float(np.min(t[inside], initial=np.inf))

    return lambda origins, directions: np.array(
        [one(o, d) for o, d in zip(origins, directions, strict=True)]
    )


@cache
def built(name: str) -> Scene:
    """The scene with its default options, built once for all tests."""
    return builtin_scene(name)


@pytest.fixture(scope="session")
def atrium_scene() -> Scene:
    return built("atrium")


@pytest.fixture(scope="session")
def atrium_caster(atrium_scene: Scene) -> Caster:
    """The atrium's stone only, in few triangles: neither cloth, leaves nor fine ornament."""
    ornament = ("drape", "rod", "plant", "pot", "soil", "balustrade", "shield")
    return make_caster(world_triangles(atrium_scene, ornament))


@pytest.fixture(scope="session")
def room_scene() -> Scene:
    return built("room")
