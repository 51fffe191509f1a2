"""Fewer triangles for maps of few texels: as much surface in the same places."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.rendering import Renderer
from airlight.scene import Camera, Environment, Geometry, Mesh, Scene, shapes
from airlight.surface import coarse
from airlight.surface.coarse import CoarseScene, coarse_triangles
from airlight.surface.geometry import GpuScene

FEW = {"resolution": 16, "sky_resolution": 32}


def hills(side=120, height=0.3):
    """A square of 4 m with hills, `side` vertices along each of its sides."""
    x, z = np.meshgrid(np.linspace(-2, 2, side), np.linspace(-2, 2, side))
    y = height * np.sin(2.0 * x) * np.cos(3.0 * z)
    at = np.arange(side * side).reshape(side, side)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[:-1, 1:], at[1:, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([c, b, d], 1)])
    positions = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32)
    return Geometry(positions, triangles.astype(np.uint32))


def leaves(count=5000):
    """Triangles of 2 cm all over a box of 4 m."""
    rng = np.random.default_rng(0)
    corners = rng.uniform(-2, 2, (count, 1, 3)) + rng.uniform(-0.01, 0.01, (count, 3, 3))
    indices = np.arange(3 * count).reshape(-1, 3).astype(np.uint32)
    return Geometry(corners.reshape(-1, 3).astype(np.float32), indices)


def area(geometry, triangles):
    a, b, c = (geometry.positions[triangles[:, k]].astype(float) for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


def test_a_surface_keeps_its_area_and_sides_with_few_triangles():
    ground = hills()
    triangles = coarse_triangles(ground, 0.1)
    assert len(triangles) < 0.25 * len(ground.indices)
    assert area(ground, triangles) == pytest.approx(area(ground, ground.indices), rel=0.05)
    a, b, c = (ground.positions[triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 1] > 0.0).mean() > 0.97
    assert len(np.unique(triangles, axis=0)) == len(triangles)


def test_leaves_smaller_than_cells_stay():
    tree = leaves()
    triangles = coarse_triangles(tree, 0.2)
    assert area(tree, triangles) == pytest.approx(area(tree, tree.indices), rel=0.02)


def test_cells_that_are_too_many_leave_all_as_it_is():
    ground = hills(10)
    assert coarse_triangles(ground, 1e-6) is ground.indices


@pytest.fixture
def always(monkeypatch):
    monkeypatch.setattr(coarse, "MOST_TRIANGLES", 0)


def test_small_scenes_are_drawn_as_they_are(gpu):
    scene = GpuScene(gpu, Scene((Mesh(hills()),)))
    assert CoarseScene(gpu, scene, 24).current() is scene


def test_it_moves_and_deforms_with_the_scene(gpu, always):
    meshes = (Mesh(hills()), Mesh(shapes.box()))
    scene = GpuScene(gpu, Scene(meshes))
    made = CoarseScene(gpu, scene, 24)
    drawn = made.current()
    first, second = drawn.current
    assert len(first.geometry.indices) < 0.25 * len(meshes[0].geometry.indices)
    assert second.geometry is meshes[1].geometry
    version = drawn.version
    assert made.current() is drawn
    assert drawn.version == version
    ground = meshes[0].geometry
    raised = dataclasses.replace(ground, positions=ground.positions + np.float32((0, 1, 0)))
    up = np.eye(4)
    up[1, 3] = 3.0
    scene.move((Mesh(raised), Mesh(meshes[1].geometry, world_from_object=up)))
    low, high = made.current().bounds
    assert made.current() is drawn
    assert drawn.version > version
    np.testing.assert_allclose(low[1], 0.7, atol=0.01)
    np.testing.assert_allclose(high[1], 3.5, atol=0.01)


def test_an_image_under_the_sky_stays_the_same(monkeypatch):
    camera = Camera(position=(0, 3, 5), target=(0, 0, 0))
    sky = Environment(map=np.random.default_rng(1).random((8, 16, 3)).astype(np.float32))
    walls = (Mesh(hills(160, 0.6)), Mesh(shapes.box()))
    scene = Scene(walls, environment=sky, camera=camera)
    images = []
    for most in (10**9, 0):
        monkeypatch.setattr(coarse, "MOST_TRIANGLES", most)
        with Renderer(scene, "direct", (64, 36), settings=FEW) as renderer:
            images.append(renderer.frame().radiance.astype(float))
    error = np.linalg.norm(images[1] - images[0]) / np.linalg.norm(images[0])
    assert 0.0 < error < 0.005
