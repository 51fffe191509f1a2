"""Planes at the ends of eye rays: they face the eye, and are only where a surface is."""

from __future__ import annotations

import numpy as np

FAR = 1e9
RNG = np.random.default_rng(11)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def test_planes_face_the_eye_and_are_surfaces_unless_they_are_along_the_ray(wgsl):
    direction, normal = (unit(RNG.normal(size=(500, 3))) for _ in range(2))
    right = unit(np.cross(normal, RNG.normal(size=(500, 3))))
    down = np.cross(normal, right) + 0.5 * right
    found = wgsl(
        "end_plane", "end_normal", direction, 3.0, FAR, 0.1 * right, -0.2 * down, returns="vec4f"
    )
    facing = np.abs(np.sum(direction * normal, axis=1))
    np.testing.assert_array_equal(found[facing < 0.099], 0.0)
    np.testing.assert_allclose(found[facing > 0.251, 3], 1.0)
    is_surface = facing > 0.101
    towards = -np.sign(np.sum(direction * normal, axis=1, keepdims=True)) * normal
    np.testing.assert_allclose(found[is_surface, :3], towards[is_surface], atol=1e-5)


def test_a_ray_that_ends_at_nothing_has_no_plane_whatever_its_neighbours_end_at(wgsl):
    """Its plane is along the ray where a neighbour ends at a surface: rounding would say which of
    the ray's points are behind it, and by how far. Pixels beside edges were black on a GPU."""
    direction = unit(RNG.normal(size=(500, 3)))
    beside = unit(direction + 0.02 * RNG.normal(size=(500, 3)))
    end = FAR * direction
    right, down = 3.0 * beside - end, FAR * np.roll(beside, 1, axis=1) - end
    found = wgsl("end_plane", "end_normal", direction, FAR, FAR, right, down, returns="vec4f")
    np.testing.assert_array_equal(found, 0.0)
