"""A device, a camera's view without surfaces, and pictures read back."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.errors import DeviceError
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu, open_gpu
from airlight.lighting.view import View
from airlight.scene.camera import Camera
from airlight.scene.scene import Scene
from airlight.surface.geometry import GpuScene


@pytest.fixture(scope="session")
def gpu() -> Gpu:
    try:
        return open_gpu()
    except DeviceError as error:
        pytest.skip(f"no graphics device: {error}")


class Look:
    """A scene seen by a camera: its G-buffer is drawn."""

    def __init__(self, gpu: Gpu, scene: Scene, size: tuple[int, int] = (24, 16)) -> None:
        self.gpu, self.scene, self.size = gpu, scene, size
        self.commands = Commands(gpu)
        self.meshes = GpuScene(gpu, scene)
        self.view = View(gpu, size)
        self.aim(scene.camera)

    def aim(self, camera: Camera) -> None:
        self.view.aim(camera)
        self.view.gbuffer.encode(self.commands, self.meshes, self.view.clip_from_world)
        self.commands.submit()

    def directions(self) -> np.ndarray:
        """(H, W, 3) unit, through the pixels' centres."""
        width, height = self.size
        x = (np.arange(width) + 0.5) / width * 2 - 1
        y = 1 - (np.arange(height) + 0.5) / height * 2
        ndc = np.stack([*np.meshgrid(x, y), np.full((height, width), 0.5)], axis=-1)
        clip = np.concatenate([ndc, np.ones((height, width, 1))], axis=-1)
        world = clip @ self.view.world_from_clip.T
        way = world[..., :3] / world[..., 3:] - self.view.eye
        return np.asarray(way / np.linalg.norm(way, axis=-1, keepdims=True))

    def read(self, texture: Any) -> np.ndarray:
        """(H, W, 3) float64, everything encoded submitted first."""
        self.commands.submit()
        return np.asarray(texture.read()[..., :3].astype(np.float64))


@pytest.fixture(scope="session")
def look(gpu: Gpu) -> Callable[..., Look]:
    """look(scene, size) -> Look."""
    return functools.partial(Look, gpu)
