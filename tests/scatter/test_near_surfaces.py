"""The cells that surfaces read are found: all around points half a cell before any surface."""

from __future__ import annotations

import numpy as np

from airlight.rendering import Renderer
from airlight.scatter.near_surfaces import NearSurfaces
from airlight.scene import Mesh, Scene
from airlight.scene.shapes import quad, sphere


def test_all_cells_that_surfaces_read_are_near_them(gpu):
    rng = np.random.default_rng(4)
    at = np.array([0.3, 0.9, -0.2])
    ball, floor = np.diag([0.5, 0.5, 0.5, 1.0]), np.diag([3.0, 1.0, 3.0, 1.0])
    ball[:3, 3] = at
    scene = Scene((Mesh(sphere(), world_from_object=ball), Mesh(quad(), world_from_object=floor)))
    settings = {"resolution": 16, "bounds": (-2, -0.5, -2, 2, 3.5, 2), "follow_walls": False}
    with Renderer(scene, "lpv", (4, 4), settings={**settings, "surfels": 20_000}) as renderer:
        renderer.frame()
        kit, origin = renderer.technique.kit, np.array(renderer.origin)
        near = NearSurfaces(kit.gpu, kit.lattices.largest)
        near.encode(renderer.commands)
        renderer.commands.submit()
        place = kit.placement
        is_near = near.cells.read().view(np.uint32).reshape(place.count[::-1])
    normals = rng.normal(size=(2000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    radius = 0.5 * np.abs(sphere().positions).max()
    on_floor = np.column_stack(
        [rng.uniform(-1.5, 1.5, 500), np.zeros(500), rng.uniform(-1.5, 1.5, 500)]
    )
    points = np.concatenate([at + radius * normals, on_floor])
    normals = np.concatenate([normals, np.tile([0.0, 1.0, 0.0], (500, 1))])
    # Lattice coordinates of the point half a cell before, and the eight cells around it.
    cells = (points - origin - np.array(place.origin)) / place.cell + 0.5 * normals - 0.5
    for corner in range(8):
        c = np.floor(cells).astype(int) + np.array([corner & 1, corner >> 1 & 1, corner >> 2])
        assert is_near[c[:, 2], c[:, 1], c[:, 0]].all()
    # Most of the space is not.
    assert 0.02 < is_near.mean() < 0.5
