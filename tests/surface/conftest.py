"""Scenes of a few squares on the device."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from airlight.scene import Scene
from airlight.surface.geometry import GpuScene


@pytest.fixture
def on_device(gpu: Any, owned: Callable[[Any], Any]) -> Callable[..., GpuScene]:
    """on_device(mesh, ...) -> GpuScene."""
    return lambda *meshes: owned(GpuScene(gpu, Scene(meshes=meshes)))
