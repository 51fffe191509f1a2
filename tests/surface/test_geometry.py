"""Meshes in shared buffers; culling that never drops what can be seen."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.maths.transforms import clip_from_view_infinite, view_from_world
from airlight.scene import DirectionalLight, Material, Mesh, Scene, shapes
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views

RNG = np.random.default_rng(11)


def box_mesh(centre, size, material=None):
    placed = np.diag([*np.broadcast_to(size, 3), 1.0])
    placed[:3, 3] = centre
    return Mesh(shapes.box(), material or Material(), placed)


def camera_clip(eye, forward):
    return clip_from_view_infinite(0.8, 1.5, 0.05) @ view_from_world(eye, forward, (0, 1, 0))


def in_image(clip_from_world, points):
    """Whether any of the world points (n, 3) falls into the image."""
    clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ clip_from_world.T
    w = clip[:, 3]
    return bool(((w > 0) & (np.abs(clip[:, 0]) <= w) & (np.abs(clip[:, 1]) <= w)).any())


def test_culling_never_drops_what_can_be_seen(gpu, owned):
    centres = RNG.uniform(-8, 8, size=(60, 3))
    sizes = RNG.uniform(0.2, 3.0, size=(60, 3))
    meshes = tuple(box_mesh(c, s) for c, s in zip(centres, sizes, strict=True))
    scene = owned(GpuScene(gpu, Scene(meshes=meshes)))
    inside = RNG.uniform(-0.5, 0.5, size=(400, 3))
    dropped = 0
    for _ in range(20):
        clip = camera_clip(RNG.uniform(-8, 8, 3), RNG.normal(size=3))
        drawn = [d.first_instance for d in scene.visible(clip)]
        for place, index in enumerate(scene.order):
            if in_image(clip, centres[index] + inside * sizes[index]):
                assert place in drawn
            else:
                dropped += place not in drawn
    assert dropped > 100  # and it is of use


def test_what_stands_before_a_lights_near_plane_still_shadows(gpu, owned):
    high_above = box_mesh((0, 50, 0), 1.0)
    scene = owned(GpuScene(gpu, Scene(meshes=(box_mesh((0, 0, 0), 4.0), high_above))))
    sun = DirectionalLight((0, -1, 0), (1, 1, 1))
    (view,) = light_views([sun], np.array([-2.0] * 3), np.array([2.0] * 3), 16)
    assert len(scene.visible(view.clip_from_world)) == 2


def test_an_empty_scene_draws_nothing(gpu, owned):
    assert owned(GpuScene(gpu, Scene())).visible(np.eye(4)) == []


def test_instances_of_one_geometry_and_material_are_one_draw(gpu, owned):
    geometry, red, leaf = shapes.quad(), Material(), Material(alpha_cutoff=0.5)

    def placed(x, material):
        matrix = np.eye(4)
        matrix[0, 3] = x
        return Mesh(geometry, material, matrix)

    meshes = tuple(placed(x, material) for x, material in enumerate([red, leaf, red, leaf, red]))
    scene = owned(GpuScene(gpu, Scene(meshes=meshes)))
    assert [draw.instance_count for draw in scene.draws] == [3, 2]
    assert scene.draws[0].material is red  # opaque before cut-out
    assert scene.order == [0, 2, 4, 1, 3]


def test_instances_are_culled_one_by_one(gpu, owned):
    """Of a row of boxes those before the eye are drawn, as runs of the one draw that they are."""
    geometry, material = shapes.box(), Material()
    xs = [-40.0, -1.0, 0.0, 1.0, 60.0, 70.0, 0.5]
    placed = np.tile(np.eye(4), (len(xs), 1, 1))
    placed[:, 0, 3] = xs
    scene = owned(GpuScene(gpu, Scene(meshes=tuple(Mesh(geometry, material, m) for m in placed))))
    ahead = camera_clip((0.0, 0.0, 6.0), (0.0, 0.0, -1.0))
    found = scene.visible(ahead)
    assert [(d.first_instance, d.instance_count) for d in found] == [(1, 3), (6, 1)]
    assert scene.visible(ahead.copy()) is found
    assert scene.visible(camera_clip((0, 0, 4000.0), (0, 0, -1.0))) is scene.draws
    assert scene.visible(camera_clip((0, 0, 6.0), (0, 0, 1.0))) == []
    scene.move(tuple(Mesh(geometry, material, m) for m in placed[::-1]))
    again = [(d.first_instance, d.instance_count) for d in scene.visible(ahead)]
    assert again == [(0, 1), (3, 3)]


def test_moving_meshes_moves_bounds_and_counts_a_version(gpu, owned):
    mesh = box_mesh((1, 2, 3), 2.0)
    scene = owned(GpuScene(gpu, Scene(meshes=(mesh,))))
    np.testing.assert_allclose(scene.bounds, [[0, 1, 2], [2, 3, 4]])
    before = scene.version
    moved = mesh.world_from_object.copy()
    moved[0, 3] += 10.0
    scene.move((dataclasses.replace(mesh, world_from_object=moved),))
    np.testing.assert_allclose(scene.bounds, [[10, 1, 2], [12, 3, 4]])
    assert scene.version == before + 1


def test_memory_is_given_back(gpu):
    before = gpu.allocated_bytes
    scope = gpu.scope()
    made = GpuScene(scope, Scene(meshes=(box_mesh((0, 0, 0), 1.0),)))
    assert gpu.allocated_bytes > before
    scope.release()
    assert gpu.allocated_bytes == before
    del made  # it was there all the time


@pytest.mark.parametrize("mirrored", [False, True])
def test_normals_stay_at_right_angles_under_uneven_scale(gpu, owned, mirrored):
    # The normal matrix against one made by finite differences of the placed surface.
    linear = RNG.normal(size=(3, 3)) + 2.0 * np.eye(3)
    if bool(np.linalg.det(linear) < 0.0) is not mirrored:
        linear[:, 0] *= -1.0
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    scene = owned(GpuScene(gpu, Scene(meshes=(Mesh(shapes.quad(), Material(), matrix),))))
    words = scene.instances.read(np.float32)
    normal_from_object = words[16:32].reshape(4, 4).T
    n = normal_from_object[:3, :3] @ np.array([0.0, 1.0, 0.0])
    expected = np.cross(linear @ [0, 0, 1], linear @ [1, 0, 0])
    expected *= -1.0 if mirrored else 1.0
    n, expected = n / np.linalg.norm(n), expected / np.linalg.norm(expected)
    np.testing.assert_allclose(n, expected, atol=1e-5)
