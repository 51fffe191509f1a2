"""Marching a constant source is the closed form; transmittance is Beer-Lambert."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from airlight.fields import ALL_MEDIA, LatticeSource, Source
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.lattice.placement import Placement
from airlight.media.gpu_media import GpuMedia
from airlight.media.march.march import March, MarchTargets, Steps
from airlight.media.march.marched_light import MarchedLight
from airlight.media.rays import Rays
from airlight.reference.quadrature import box_path, sphere_path
from airlight.scene.camera import Camera
from airlight.scene.medium import Medium
from airlight.scene.mesh import Mesh
from airlight.scene.scene import Scene
from airlight.scene.shapes import quad
from airlight.scene.volume import Volume

BOX = ((-1.0, -0.8, -1.2), (1.0, 1.1, 1.3))
SIGMA_T, ALBEDO = np.array([0.4, 0.9, 1.6]), np.array([0.9, 0.5, 1.0])
EYES = {"outside": (0.4, 0.3, 4.0), "inside": (0.2, 0.1, 0.5), "straddling": (0.0, 0.0, 1.3)}


def fog(eye: tuple[float, float, float], **changes: object) -> Scene:
    medium = Medium(tuple(SIGMA_T), tuple(ALBEDO), bounds=BOX)
    camera = Camera(eye, (0.05, 0.0, -1.0), fov_y_deg=55)
    return dataclasses.replace(Scene(medium=medium, camera=camera), **changes)


def constant(gpu: Gpu, rgb: tuple[float, float, float]) -> Texture:
    texels = np.ones((5, 4, 6, 4), np.float16)
    texels[..., :3] = rgb
    made = Texture(gpu, "J", (6, 4, 5), "rgba16float", dimension="3d")
    made.write(texels)
    return made


def marched(
    gpu: Gpu,
    seen: Any,
    sources: list[Source],
    scale: int = 1,
    lattice: LatticeSource | None = None,
    **options: Any,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(scattered, transmittance, picked)."""
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays = Rays(gpu, seen.size, scale)
    march = March(gpu, air, sources=len(sources))
    out = [
        Texture(gpu, n, rays.reduced, "rgba32float", target=True, written=True) for n in ("L", "T")
    ]
    rays.encode(seen.commands, seen.view)
    march.encode(
        seen.commands,
        rays,
        MarchedLight(sources, lattice),
        MarchTargets(*out),
        Steps(**options),
    )
    return seen.read(out[0]), seen.read(out[1]), seen.read(rays.picked)


def in_box(gpu: Gpu, rgb: tuple[float, float, float], **more: object) -> Source:
    matrix = np.diag([*(1.0 / np.subtract(BOX[1], BOX[0])), 1.0])
    matrix[:3, 3] = -np.array(BOX[0]) / np.subtract(BOX[1], BOX[0])
    return Source(constant(gpu, rgb), matrix, **more)


@pytest.mark.parametrize("eye", EYES.values(), ids=EYES.keys())
def test_constant_emission_is_the_closed_form(
    gpu: Gpu, look: Any, eye: tuple[float, float, float]
) -> None:
    seen = look(fog(eye))
    L, T, _ = marched(gpu, seen, [in_box(gpu, (0.5, 1.0, 2.0), scale=3.0)], cutoff=0.0)
    entry, leave = box_path(np.array(eye), seen.directions(), BOX)
    expected = np.exp(-SIGMA_T * (leave - entry)[..., None])
    np.testing.assert_allclose(T, expected, rtol=2e-5)
    np.testing.assert_allclose(
        L, np.array([1.5, 3.0, 6.0]) / SIGMA_T * (1 - expected), rtol=2e-4, atol=1e-6
    )


def test_mean_radiance_is_scattered_by_the_medium(gpu: Gpu, look: Any) -> None:
    seen = look(fog(EYES["outside"]))
    L, T, _ = marched(gpu, seen, [in_box(gpu, (1.0, 1.0, 1.0), medium=ALL_MEDIA)])
    np.testing.assert_allclose(L, ALBEDO * (1 - T), rtol=2e-3, atol=1e-5)


def test_marching_ends_at_surfaces(gpu: Gpu, look: Any) -> None:
    wall = np.diag([8.0, 1.0, 8.0, 1.0]) @ np.eye(4)
    turned = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, -0.3], [0, 0, 0, 1.0]])
    mesh = Mesh(quad(), world_from_object=turned @ wall)
    seen = look(fog(EYES["outside"], meshes=(mesh,)))
    _, T, picked = marched(gpu, seen, [])
    d = seen.directions()
    distance = (-0.3 - EYES["outside"][2]) / d[..., 2]
    np.testing.assert_allclose(picked[..., 0], distance, rtol=1e-5)
    entry, leave = box_path(np.array(EYES["outside"]), d, BOX)
    path = np.maximum(np.minimum(leave, distance) - entry, 0.0)[..., None]
    np.testing.assert_allclose(T, np.exp(-SIGMA_T * path), rtol=1e-4)


def test_media_overlap_and_add(gpu: Gpu, look: Any) -> None:
    """Fog, an ellipsoid in it and a density grid of ones that is turned and stretched."""
    angle = 0.4
    turn = np.array(
        [
            [np.cos(angle), 0, np.sin(angle), 0.3],
            [0, 1, 0, 0.1],
            [-np.sin(angle), 0, np.cos(angle), -0.2],
            [0, 0, 0, 1],
        ]
    )
    stretch = turn @ np.diag([0.7, 1.3, 1.0, 1.0])
    ball = Volume((2.0, 1.0, 0.5), shape="sphere", bounds=((-0.7,) * 3, (0.7,) * 3))
    grid = Volume(
        (0.3, 0.6, 0.9),
        density=np.ones((5, 3, 4), np.float32),
        bounds=((-0.5, -0.4, -0.6), (0.5, 0.6, 0.3)),
        world_from_volume=stretch,
    )
    seen = look(fog(EYES["outside"], volumes=(ball, grid)), (48, 32))
    _, T, _ = marched(gpu, seen, [], cutoff=0.0)
    eye, d = np.array(EYES["outside"]), seen.directions()
    depth = SIGMA_T * np.subtract(*box_path(eye, d, BOX)[::-1])[..., None]
    depth = (
        depth
        + np.array(ball.sigma_t)
        * np.subtract(*sphere_path(eye, d, (0, 0, 0), 0.7)[::-1])[..., None]
    )
    back = np.linalg.inv(stretch)
    local_d, local_eye = d @ back[:3, :3].T, back[:3, :3] @ eye + back[:3, 3]
    depth = (
        depth
        + np.array(grid.sigma_t)
        * np.subtract(*box_path(local_eye, local_d, grid.bounds)[::-1])[..., None]
    )
    np.testing.assert_allclose(T, np.exp(-depth), rtol=5e-4, atol=1e-6)


def test_lattice_of_one_state_everywhere(gpu: Gpu, look: Any) -> None:
    """J = sigma_s scale (a + g b.w), w the direction of travel towards the eye."""
    g = 0.6
    medium = Medium(tuple(SIGMA_T), tuple(ALBEDO), (g, g, g), BOX)
    seen = look(fog(EYES["outside"], medium=medium))
    placement = Placement((-4.0, -4.0, -4.0), 1.0, (8, 8, 8))
    state = np.array([2.0, 0.3, -0.4, 0.8], np.float16)
    textures = {}
    for name in ("red", "green", "blue"):
        textures[f"lattice_{name}"] = Texture(gpu, name, (8, 8, 8), "rgba16float", dimension="3d")
        textures[f"lattice_{name}"].write(np.tile(state, (8, 8, 8, 1)))
    for name, value in (("visibility_a", 1.0), ("visibility_b", 1.0), ("walls", 0.0)):
        made = Texture(gpu, name, (8, 8, 8), "rgba16float", dimension="3d")
        made.write(np.full((8, 8, 8, 4), value, np.float16))
        textures[f"lattice_{name}"] = made
    lattice = LatticeSource(placement, textures, scale=0.5, direct=1.0)
    L, T, _ = marched(gpu, seen, [], lattice=lattice)
    radiance = 0.5 * (2.0 + g * (-seen.directions() @ state[1:].astype(float)))
    expected = ALBEDO * (1 - T) * radiance[..., None]
    np.testing.assert_allclose(L, expected, rtol=5e-3, atol=1e-4)
