"""Lattices on the device, and the textures that say where walls are."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.memory import Texture
from airlight.lattice.blockers import Blockers
from airlight.lattice.placement import Placement
from airlight.scene import Mesh, Scene
from airlight.surface.geometry import GpuScene


@pytest.fixture
def on_device(gpu: Any, owned: Callable[[Any], Any]) -> Callable[..., GpuScene]:
    """on_device(mesh, ...) -> GpuScene."""

    def upload(*meshes: Mesh) -> GpuScene:
        return owned(GpuScene(gpu, Scene(meshes=meshes)))

    return upload


@pytest.fixture
def cells_texture(gpu: Any, owned: Callable[[Any], Any]) -> Callable[..., Texture]:
    """cells_texture(placement, "rgba8snorm", values (Z, Y, X, 4)) -> 3D texture; 0 by default."""

    def make(placement: Placement, format: str, values: Any = 0) -> Texture:
        dtype = {"rgba8snorm": np.int8, "rgba8unorm": np.uint8, "rgba16float": np.float16}[format]
        texture = owned(Texture(gpu, "cells", placement.count, format, dimension="3d"))
        whole = np.broadcast_to(np.asarray(values, dtype), (*placement.count[::-1], 4))
        texture.write(np.ascontiguousarray(whole))
        return texture

    return make


@pytest.fixture
def encoded_blockers(
    gpu: Any, commands: Any, owned: Callable[[Any], Any], on_device: Callable[..., GpuScene]
) -> Callable[..., Blockers]:
    """encoded_blockers(placement, surfels, mesh, ...) -> Blockers of these meshes, encoded."""

    def solve(placement: Placement, surfels: int, *meshes: Mesh) -> Blockers:
        made = owned(Blockers(gpu, Scene(meshes=meshes), on_device(*meshes), placement, surfels))
        assert made.encode(commands)
        commands.submit()
        return made

    return solve
