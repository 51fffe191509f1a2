"""Lattices of points become triangles that face along their normals."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import Material
from airlight.scene.builtin.patch import Finish, lattice_normals, merged, moved, patch, placed_at


def sheet(normal: tuple[float, float, float]):
    x, z = np.meshgrid(np.linspace(0, 2, 3), np.linspace(0, 1, 2))
    points = np.stack([x, 0 * x, z], axis=-1)
    return patch(points, np.broadcast_to(normal, points.shape), points[..., [0, 2]])


@pytest.mark.parametrize("up", [1.0, -1.0])
def test_winding_follows_the_normals(up: float) -> None:
    flat = sheet((0.0, 3.0 * up, 0.0))
    p = flat.positions[flat.indices]
    assert np.all(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])[:, 1] * up > 0)
    assert np.allclose(flat.normals, (0, up, 0))
    assert len(flat.indices) == 4


def test_triangles_without_area_and_unused_points_are_dropped() -> None:
    points = np.zeros((2, 3, 3))
    points[1, :, 0], points[1, :, 2] = (0, 1, 2), 1.0
    fan = patch(points, np.broadcast_to((0, 1.0, 0), points.shape), np.zeros((2, 3, 2)))
    assert len(fan.indices) == 2 and len(fan.positions) == 5


def test_lattice_normals_of_a_closed_tube() -> None:
    angle = np.linspace(0, 2 * np.pi, 33)
    ring = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    tube = ring[None] + np.array([[[0, 0, 0.0]], [[0, 1.0, 0]], [[0, 2.0, 0]]])
    normals = -lattice_normals(tube, closed_columns=True)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    assert np.allclose(normals, np.broadcast_to(ring, tube.shape), atol=1e-12)


def test_move_merge_and_paint() -> None:
    turned = moved(sheet((0, 1, 0)), placed_at(5.0, 1.0, 0.0, turn_deg=90.0, scale=2.0))
    assert np.allclose(turned.positions.max(axis=0), (7.0, 1.0, 0.0), atol=1e-6)
    assert np.allclose(np.linalg.norm(turned.normals, axis=1), 1.0)
    both = merged([turned, turned])
    assert len(both.indices) == 8 and both.indices.max() == 2 * len(turned.positions) - 1
    places = [placed_at(0, 0, 0), placed_at(1, 0, 0)]
    one, two = Finish(Material(), tile_m=2.0).meshes(both, "pair", places)
    assert one.geometry is two.geometry
    assert np.allclose(one.geometry.uvs, both.uvs / 2.0)
    assert two.world_bounds[0][0] == pytest.approx(one.world_bounds[0][0] + 1.0)
