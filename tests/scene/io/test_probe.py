"""Rays against triangles: known places, and the two ways to cast against each other."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.io.probe import Probe, sphere_directions
from airlight.scene.material import Material
from airlight.scene.mesh import Geometry, Mesh
from airlight.scene.scene import Scene


def soup(count: int) -> Scene:
    rng = np.random.default_rng(4)
    corners = rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(scale=0.3, size=(count, 3, 3))
    positions = corners.reshape(-1, 3).astype(np.float32)
    return Scene((Mesh(Geometry(positions, np.arange(3 * count).reshape(-1, 3))),))


def test_a_ray_stops_at_the_nearest_front():
    positions = np.array([(-9, -9, z) for z in (0, 1)] + [(9, -9, 0), (9, -9, 1)], np.float32)
    positions = np.concatenate([positions, np.array([(0, 9, 0), (0, 9, 1)], np.float32)])
    scene = Scene((Mesh(Geometry(positions, np.array([(0, 2, 4), (1, 3, 5)]))),))
    probe = Probe.of(scene)
    origins = np.array([(0, 0, 5), (0, 0, -5), (0, 0, 5), (99, 0, 5)], dtype=float)
    directions = np.array([(0, 0, -1), (0, 0, 1), (0, 0, 1), (0, 0, -1)], dtype=float)
    hits = probe.cast(origins, directions)
    np.testing.assert_allclose(hits.distance, [4, 5, np.inf, np.inf], rtol=1e-5)
    assert hits.is_front.tolist() == [True, False, False, False]


def test_parallel_rays_agree_with_single_ones():
    probe = Probe.of(soup(1500))
    points = np.random.default_rng(0).uniform(-2, 2, (60, 3))
    for direction in sphere_directions(25):
        single = probe.cast(points, np.repeat(direction[None], len(points), axis=0))
        np.testing.assert_array_equal(probe.sees_sky(points, direction), np.isinf(single.distance))


def test_against_linear_equations():
    """o + t d = a + u e1 + v e2, solved for every ray and triangle."""
    scene = soup(200)
    directions = sphere_directions(100)
    origin = np.array([0.1, 0.2, 0.3])
    geometry = scene.meshes[0].geometry
    a, b, c = geometry.positions[geometry.indices].astype(float).transpose(1, 0, 2)
    columns = np.broadcast_arrays(-directions[:, None], b - a, c - a)
    solved = np.linalg.solve(np.stack(columns, axis=-1), (origin - a)[None, ..., None])
    t, u, v = np.moveaxis(solved, 2, 0)
    t = np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0), t, np.inf)
    hits = Probe.of(scene).cast(np.tile(origin, (100, 1)), directions)
    np.testing.assert_allclose(hits.distance, t[..., 0].min(axis=1), rtol=1e-3)


def test_what_lets_light_through_is_not_there():
    mesh = soup(3).meshes[0]
    glass = Material(alpha=0.1, alpha_cutoff=0.5)
    assert len(Probe.of(Scene((Mesh(mesh.geometry, glass),))).corners) == 0
    empty = Probe.of(Scene())
    assert empty.sees_sky(np.zeros((2, 3)), np.array([0, 1.0, 0])).all()
    assert np.isinf(empty.cast(np.zeros((1, 3)), np.array([[0, 1.0, 0]])).distance).all()


def test_directions_cover_the_sphere():
    directions = sphere_directions(200)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1)
    np.testing.assert_allclose(directions.mean(axis=0), 0, atol=0.01)
    np.testing.assert_allclose((directions**2).mean(axis=0), 1 / 3, atol=0.01)


def pane(material: Material, z: float = 0.0) -> Mesh:
    positions = np.array([(-9, -9, z), (9, -9, z), (0, 9, z)], np.float32)
    return Mesh(Geometry(positions, np.array([(0, 1, 2)])), material)


GLASS = [
    Material(transmission=1.0),
    Material(alpha=0.5, is_blended=True),
    Material(alpha=0.9, is_blended=True, transmission=0.3),
]
WALLS = [
    Material(),
    Material(transmission=1.0, metallic=1.0),
    Material(alpha=0.5),
    Material(alpha=0.9, is_blended=True),
    Material(transmission=0.2),
]


@pytest.mark.parametrize("material", [*GLASS, *WALLS])
def test_light_passes_panes_and_people_do_not(material):
    """Before a wall one metre on; the pane's triangle stays in what is framed."""
    scene = Scene((pane(material), pane(Material(), -1.0)))
    start, towards = np.array([(0.0, 0.0, 3.0)]), np.array([(0.0, 0.0, -1.0)])
    light, person = Probe.of(scene), Probe.of(scene, through_panes=False)
    hits = light.cast(start, towards)
    assert hits.distance[0] == pytest.approx(4.0 if material in GLASS else 3.0)
    assert light.mesh[hits.triangle[0]] == (1 if material in GLASS else 0)
    assert person.cast(start, towards).distance[0] == pytest.approx(3.0)
    assert len(light.corners) == 2
    # Towards the sky only the pane is in the way.
    between = np.array([(0.0, 0.0, -0.5)])
    assert light.sees_sky(between, -towards[0])[0] == (material in GLASS)
    assert light.largest(1).sees_sky(between, -towards[0])[0] == (material in GLASS)


def test_a_scene_of_glass_alone_stops_no_ray():
    probe = Probe.of(Scene((pane(GLASS[0]),)))
    hits = probe.cast(np.array([(0.0, 0.0, 3.0)]), np.array([(0.0, 0.0, -1.0)]))
    assert np.isinf(hits.distance[0]) and hits.triangle[0] == -1
