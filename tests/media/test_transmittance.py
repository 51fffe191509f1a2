"""Beer-Lambert to a surface behind a box of air, and to the background."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.media.compositing.transmittance import Transmittance
from airlight.media.gpu_media import GpuMedia
from airlight.media.rays import Rays
from airlight.reference.quadrature import box_path
from airlight.scene import Camera, Medium, Mesh, Scene

BOX = ((-1.0, -0.8, -1.2), (1.0, 1.1, 1.3))
SIZE = (24, 16)


def test_beer_lambert(gpu: Gpu, look: Any, square: Callable[..., Mesh]) -> None:
    sigma_t = (0.4, 0.9, 1.6)
    half_wall = square((-10, 0, 0.2), (10, 0, 0), (0, 20, 0))
    camera = Camera((0.3, 0.2, 4.0), (0, 0, -1), fov_y_deg=50)
    scene = Scene(meshes=(half_wall,), camera=camera, medium=Medium(sigma_t, bounds=BOX))
    seen = look(scene, SIZE)
    air = GpuMedia(gpu, scene, light_count=0)
    air.update(seen.commands, scene, *scene.bounds)
    target = Texture(gpu, "T", SIZE, "rgba32float", target=True, written=True)
    rays = Rays(gpu, SIZE, 1)
    rays.encode(seen.commands, seen.view)
    Transmittance(gpu, air).encode(seen.commands, rays, seen.view.gbuffer.depth, target)
    eye, d = np.array(camera.position), seen.directions()
    entry, leave = box_path(eye, d, BOX)
    wall = (0.2 - eye[2]) / d[..., 2]
    leave = np.where(eye[0] + wall * d[..., 0] < 0.0, np.clip(wall, entry, leave), leave)
    expected = np.exp(-(leave - entry)[..., None] * sigma_t)
    np.testing.assert_allclose(seen.read(target), expected, rtol=1e-5)


def test_no_air_takes_nothing(gpu: Gpu, look: Any) -> None:
    seen = look(Scene(), SIZE)
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    target = Texture(gpu, "T", SIZE, "rgba32float", target=True, written=True)
    rays = Rays(gpu, SIZE, 1)
    rays.encode(seen.commands, seen.view)
    Transmittance(gpu, air).encode(seen.commands, rays, seen.view.gbuffer.depth, target)
    assert np.all(seen.read(target) == 1.0)
