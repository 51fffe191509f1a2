"""A renderer and the scene that it shows in the viewer: solved only where something changed."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..rendering import Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene


class Drawn:
    """For one thread at a time. `solve_ms`: what the last `solve` took on a software driver."""

    def __init__(self, renderer: Renderer) -> None:
        self.renderer = renderer
        self.solve_ms = 0.0
        self._solved: tuple[Any, ...] = ()

    def give(self, scene: Scene) -> None:
        """Show `scene`, which has the structure of the one the renderer was made for."""
        r = self.renderer
        if scene.meshes is not r.scene.meshes:
            r.meshes.move(scene.meshes)
        r.scene = scene

    def solve(self, commands: Commands) -> None:
        """All that the camera does not matter for, unless nothing else has changed."""
        self.solve_ms = 0.0
        r = self.renderer
        now = solved_by(r)
        if is_same(now, self._solved):
            return
        begin = time.perf_counter()
        r.technique.solve(commands, r.scene)
        self._solved = now
        if r.gpu.is_cpu:
            commands.submit()
            r.gpu.wait()
            self.solve_ms = (time.perf_counter() - begin) * 1e3

    def draw(
        self, commands: Commands, camera: Camera, jitter: tuple[float, float], sample: int
    ) -> None:
        """The layers of one sample, from `camera`."""
        r = self.renderer
        r.view.aim(camera, jitter, sample)
        r.technique.draw(commands, r.view)

    def close(self) -> None:
        """Give the device's memory back."""
        self.renderer.close()


def solved_by(r: Renderer) -> tuple[Any, ...]:
    """What the solution of the renderer's scene depends on."""
    scene = r.scene
    parts = (scene.lights, scene.light_groups, scene.medium, scene.volumes,
             scene.environment, scene.meshes)  # fmt: skip
    # Fog without bounds reaches to the camera where that stands outside the scene.
    fog = scene.medium
    place = scene.camera.position if fog is not None and fog.bounds is None else None
    if place is not None:
        low, high = scene.bounds
        place = None if np.all(place >= low) and np.all(place <= high) else place
    # Nested lattices follow the camera.
    nested = scene.camera if "cascades" in r.technique.stats else None
    return (*parts, place, nested)


def is_same(now: tuple[Any, ...], before: tuple[Any, ...]) -> bool:
    """Whether nothing changed; scenes and their parts are compared by identity, they are frozen."""
    plain = (str, bool, float, tuple, Camera)
    return len(now) == len(before) and all(
        a is b or (isinstance(a, plain) and a == b) for a, b in zip(now, before, strict=True)
    )
