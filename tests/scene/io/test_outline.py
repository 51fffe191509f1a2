"""The outline of a scene holds what is furthest out, wherever one looks from."""

from __future__ import annotations

import numpy as np

from airlight.scene import Geometry, Material, Mesh, Scene
from airlight.scene.io.defaults import with_default_camera
from airlight.scene.io.outline import DIRECTIONS, outline
from airlight.scene.io.probe import MAX_TRIANGLES


def cloud(count: int, seed: int = 0) -> Geometry:
    """Small triangles all over a lopsided blob, far from the origin; the last vertex is unused."""
    rng = np.random.default_rng(seed)
    middles = rng.normal(size=(count, 1, 3)) * (3.0, 1.0, 0.5) + (50.0, 20.0, -30.0)
    points = (middles + 0.01 * rng.normal(size=(count, 3, 3))).reshape(-1, 3)
    positions = np.append(points, [(1e6, 0.0, 0.0)], axis=0).astype(np.float32)
    return Geometry(positions, np.arange(3 * count).reshape(-1, 3))


def reaches(points: np.ndarray, directions: np.ndarray) -> np.ndarray:
    return (points @ directions.T).max(axis=0)


def test_it_reaches_as_far_as_all_vertices():
    geometry = cloud(40_000)
    points, found = geometry.positions[:-1].astype(float), outline(Scene((Mesh(geometry),)))
    assert len(found) <= DIRECTIONS
    directions = np.random.default_rng(1).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    short = reaches(points, directions) - reaches(found, directions)
    assert 0.0 <= short.max() < 0.02 * np.ptp(points, axis=0).max()


def test_of_few_points_it_has_all_and_of_what_is_cut_out_none():
    few = cloud(20)
    matrix = np.diag((2.0, -1.0, 3.0, 1.0))
    matrix[:3, 3] = (1.0, 2.0, 3.0)
    cut = Material(alpha=0.2, alpha_cutoff=0.5)
    scene = Scene((Mesh(few, world_from_object=matrix), Mesh(few), Mesh(cloud(30, 1), cut)))
    points = few.positions[:-1].astype(float)
    np.testing.assert_allclose(outline(scene)[:60], points * (2, -1, 3) + (1, 2, 3), rtol=1e-6)
    np.testing.assert_allclose(outline(scene)[60:], points, rtol=1e-6)
    assert outline(Scene()).shape == (0, 3)


def test_a_camera_has_small_triangles_in_its_image_too():
    """A large block of many triangles, and beside it small ones, which no probe keeps."""
    steps = np.linspace(0.0, 1.0, 80)
    x, y = np.meshgrid(steps, steps)
    grid = np.stack([x, y, 0.0 * x], axis=-1).reshape(-1, 3)
    first = (np.arange(79)[:, None] * 80 + np.arange(79)).ravel()
    halves = [first, first + 1, first + 80], [first + 1, first + 81, first + 80]
    faces = np.concatenate([np.stack(half, axis=1) for half in halves])
    assert len(faces) > MAX_TRIANGLES
    speck = np.array([(3, 0, 0), (3.001, 0, 0), (3, 0.001, 0)], np.float32)
    block = Geometry(grid.astype(np.float32), faces)
    meshes = (Mesh(block), Mesh(Geometry(speck, np.array([(0, 1, 2)]))))
    camera = with_default_camera(Scene(meshes)).camera
    forward = np.subtract(camera.target, camera.position)
    right = np.cross(forward / np.linalg.norm(forward), (0, 1, 0))
    right /= np.linalg.norm(right)
    offset = np.subtract((3, 0, 0), camera.position)
    across = offset @ right / (offset @ forward / np.linalg.norm(forward))
    assert abs(across) < 4 / 3 * np.tan(np.radians(camera.fov_y_deg) / 2)
