"""Scenes of a few squares on the device."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from airlight.scene import Scene
from airlight.surface.geometry import GpuScene
from airlight.surface.packed_maps import uses_visibility_buffer


@pytest.fixture
def on_device(gpu: Any, owned: Callable[[Any], Any]) -> Callable[..., GpuScene]:
    """on_device(mesh, ...) -> GpuScene."""
    return lambda *meshes: owned(GpuScene(gpu, Scene(meshes=meshes)))


@pytest.fixture(params=["triangles that are seen", "surfaces as they come"])
def both_ways(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, gpu: Any
) -> Callable[[str], None]:
    """both_ways(module of surface): it draws as CPU adapters do, then as GPUs do.

    A GPU is asked for its own way alone.
    """

    def choose(module: str) -> None:
        if request.param == "surfaces as they come":
            name = f"airlight.surface.{module}.uses_visibility_buffer"
            monkeypatch.setattr(name, lambda gpu: False)
        elif not uses_visibility_buffer(gpu):
            pytest.skip("on this device triangles are drawn as they come")

    return choose
