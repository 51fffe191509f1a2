"""What media emit, along eye rays: closed forms of boxes and balls, quadrature through grids."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.media.emission_grids import EmissionGrids
from airlight.media.gpu_media import GpuMedia
from airlight.media.march.march import March, MarchTargets
from airlight.media.march.marched_light import MarchedLight
from airlight.media.rays import Rays
from airlight.reference.quadrature import box_path, sphere_path
from airlight.scene.camera import Camera
from airlight.scene.emission import Emission
from airlight.scene.medium import Medium
from airlight.scene.scene import Scene
from airlight.scene.volume import Volume

BOX = ((-1.0, -0.8, -1.2), (1.0, 1.1, 1.3))
SIGMA_T, GLOW = np.array([0.4, 0.9, 1.6]), (3.0, 2.0, 0.5)
EYES = {"outside": (0.4, 0.3, 4.0), "inside": (0.2, 0.1, 0.5)}


def scene(eye: tuple[float, float, float], **changes: Any) -> Scene:
    return Scene(camera=Camera(eye, (0.05, 0.0, -1.0), fov_y_deg=55), **changes)


def drawn(gpu: Gpu, seen: Any) -> np.ndarray:
    """Radiance (h, w, 3) that is marched where no solver yields any light."""
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays = Rays(gpu, seen.size, 1)
    out = [
        Texture(gpu, n, rays.reduced, "rgba32float", target=True, written=True) for n in ("L", "T")
    ]
    rays.encode(seen.commands, seen.view)
    March(gpu, air).encode(seen.commands, rays, MarchedLight(), MarchTargets(*out))
    return seen.read(out[0])


@pytest.mark.parametrize("eye", EYES.values(), ids=EYES.keys())
def test_a_homogeneous_medium_is_the_closed_form(
    gpu: Gpu, look: Any, eye: tuple[float, float, float]
) -> None:
    seen = look(scene(eye, medium=Medium(tuple(SIGMA_T), 0.5, bounds=BOX, emission=GLOW)))
    entry, leave = box_path(np.array(eye), seen.directions(), BOX)
    expected = np.array(GLOW) / SIGMA_T * (1.0 - np.exp(-SIGMA_T * (leave - entry)[..., None]))
    # Short paths through the corners are differences of single precision numbers.
    np.testing.assert_allclose(drawn(gpu, seen), expected, rtol=2e-5, atol=1e-5)


def test_a_clear_ball_glows_by_the_length_of_its_chord(gpu: Gpu, look: Any) -> None:
    """No extinction at all; and a scattering box around it, whose extinction counts."""
    ball = Volume((0.0,) * 3, shape="sphere", emission=Emission(GLOW))
    seen = look(scene(EYES["outside"], volumes=(ball,)))
    near, far = sphere_path(np.array(EYES["outside"]), seen.directions(), np.zeros(3), 1.0)
    chord = np.maximum(far - near, 0.0)[..., None]
    np.testing.assert_allclose(drawn(gpu, seen), chord * GLOW, rtol=2e-4, atol=1e-4)


def test_a_grid_is_the_quadrature_of_emission_through_extinction(gpu: Gpu, look: Any) -> None:
    """Density and colours of their own: J = radiance * grid, whatever the density is."""
    rng = np.random.default_rng(5)
    density = rng.uniform(0.0, 2.0, (12, 10, 11)).astype(np.float32)
    glow = rng.uniform(0.0, 7.0, (12, 10, 11, 3)).astype(np.float32)
    volume = Volume(tuple(SIGMA_T), density, bounds=BOX, emission=Emission((1.0, 2.0, 3.0), glow))
    seen = look(scene(EYES["outside"], volumes=(volume,)))
    eye, directions = np.array(EYES["outside"]), seen.directions()
    entry, leave = box_path(eye, directions, BOX)
    steps = 400
    t = entry[..., None] + (leave - entry)[..., None] * (np.arange(steps) + 0.5) / steps
    points = eye + t[..., None] * directions[..., None, :]
    dt = ((leave - entry) / steps)[..., None, None]
    extinction = looked_up(density[..., None], points) * SIGMA_T
    emitted = looked_up(glow, points) * (1.0, 2.0, 3.0)
    depth = (np.cumsum(extinction, axis=-2) - 0.5 * extinction) * dt
    expected = (emitted * np.exp(-depth)).sum(axis=-2) * dt[..., 0, :]
    image = drawn(gpu, seen)
    # Steps of a voxel through white noise, and half floats: 2 % of a pixel, the mean far less.
    np.testing.assert_allclose(image, expected, rtol=0.04, atol=0.02 * expected.max())
    np.testing.assert_allclose(image.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), rtol=4e-3)


def test_an_emission_alone_follows_the_density(gpu: Gpu, look: Any) -> None:
    density = np.random.default_rng(6).uniform(0.0, 2.0, (6, 7, 8)).astype(np.float32)
    plain = Volume((0.5,) * 3, density, bounds=BOX, emission=Emission(GLOW))
    same = dataclasses.replace(plain, emission=Emission(GLOW, density))
    images = [drawn(gpu, look(scene(EYES["outside"], volumes=(v,)))) for v in (plain, same)]
    assert images[0].max() > 1.0
    np.testing.assert_allclose(images[0], images[1], rtol=2e-3)


def test_grids_of_several_volumes_are_read_apart(gpu: Gpu, look: Any) -> None:
    """Clear volumes in one place: what both emit is the sum."""
    rng = np.random.default_rng(7)
    volumes = []
    for shape, color in (((5, 9, 4), (1.0, 0.2, 0.1)), ((7, 3, 6), (0.1, 0.4, 2.0))):
        glow = rng.uniform(0.0, 2.0, (*shape, 3)).astype(np.float32)
        dense = np.ones(shape, np.float32)
        volumes.append(Volume((0.0,) * 3, dense, bounds=BOX, emission=Emission(color, glow)))
    one, two, both = (
        drawn(gpu, look(scene(EYES["outside"], volumes=tuple(seen))))
        for seen in (volumes[:1], volumes[1:], volumes)
    )
    assert min(one.max(), two.max()) > 0.5
    # Steps lie elsewhere among the voxels of both.
    np.testing.assert_allclose(both, one + two, atol=0.02 * both.max())


def test_more_grids_than_a_texture_is_high_fit_beside_one_another(gpu: Gpu) -> None:
    high = gpu.limits["max-texture-dimension-3d"] // 2
    tall = np.ones((high, 1, 1), np.float32)
    volumes = tuple(Volume((1.0,) * 3, tall, emission=Emission(GLOW, tall)) for _ in range(3))
    grids = EmissionGrids(gpu, volumes)
    assert len({place.first for place in grids.places}) == 3
    assert all(place.count == (1.0, 1.0, high) for place in grids.places)


def test_frames_bring_new_emission_but_no_new_kind_of_it(gpu: Gpu, look: Any) -> None:
    density = np.ones((4, 4, 4), np.float32)
    volume = Volume((0.5,) * 3, density, bounds=BOX, emission=Emission(GLOW, density))
    seen = look(scene(EYES["outside"], volumes=(volume,)))
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    before = air.version
    brighter = dataclasses.replace(volume, emission=Emission(GLOW, 2.0 * density))
    air.update(
        seen.commands, dataclasses.replace(seen.scene, volumes=(brighter,)), *seen.scene.bounds
    )
    assert air.version > before
    assert air.rows[0]["emission"] == (6.0, 4.0, 1.0)
    without = dataclasses.replace(volume, emission=Emission(GLOW))
    with pytest.raises(SceneError, match="emission got a grid, lost it"):
        air.update(
            seen.commands, dataclasses.replace(seen.scene, volumes=(without,)), *seen.scene.bounds
        )


def looked_up(grid: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Trilinear, voxel-centred over BOX, clamped at its faces; grid (z, y, x, c)."""
    counts = np.array(grid.shape[2::-1])
    at = (points - BOX[0]) / np.subtract(BOX[1], BOX[0]) * counts - 0.5
    at = np.clip(at, 0.0, counts - 1.0)
    low = np.minimum(at.astype(int), counts - 2)
    u = at - low
    total = 0.0
    for k in range(8):
        corner = np.array([k & 1, (k >> 1) & 1, k >> 2])
        weight = np.prod(np.where(corner, u, 1.0 - u), axis=-1)
        x, y, z = np.moveaxis(low + corner, -1, 0)
        total = total + weight[..., None] * grid[z, y, x]
    return total
