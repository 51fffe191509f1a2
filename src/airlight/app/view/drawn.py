"""A renderer and the scene that it shows in the viewer: solved only where something changed."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

import numpy as np

from ...gpu.commands import Commands
from ...lpv.solver import LpvSolver
from ...rendering import Renderer
from ...scene.camera import Camera
from ...scene.scene import Scene

QUICK_COARSENESS = 2.0
"""How much larger the texels of directional lights' shadow maps are, as pixels are then."""
QUICK_STEPS = 32
"""The fewest with an estimate of what later ones would add: living room, .86 of 64 steps' light."""


class Drawn:
    """For one thread at a time. `solve_ms`: what the last `solve` took on a CPU adapter."""

    def __init__(self, renderer: Renderer) -> None:
        self.renderer = renderer
        self.solve_ms = 0.0
        self._solved: tuple[Any, ...] = ()
        self._is_quick = False

    def give(self, scene: Scene) -> None:
        """Show `scene`, which has the structure of the one the renderer was made for."""
        self.renderer.show(scene)

    def solve(self, commands: Commands, *, is_quick: bool = False, is_still: bool = False) -> None:
        """All that the camera does not matter for, unless nothing else has changed.

        `is_quick`: a hand moves what shines, and fewer steps of propagation and coarser shadows
        will do for now on a CPU adapter; what was solved so is solved again where it is not.
        `is_still`: for an image of several samples, as always or never of this renderer.
        """
        self.solve_ms = 0.0
        r = self.renderer
        now = solved_by(r)
        if is_same(now, self._solved) and (is_quick or not self._is_quick):
            return
        begin = time.perf_counter()
        self._is_quick = is_quick and r.gpu.is_cpu
        with _quickly(r) if self._is_quick else nullcontext():
            r.technique.solve(commands, r.show(r.scene), is_still=is_still)
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
        r.aim(camera, jitter, sample)
        r.technique.draw(commands, r.view)

    def close(self) -> None:
        """Give the device's memory back."""
        self.renderer.close()


@contextmanager
def _quickly(r: Renderer) -> Iterator[None]:
    """A context with coarser shadow maps, and no more than QUICK_STEPS steps of propagation."""
    lights, lattice = r.technique.kit.lights, r.technique.find(LpvSolver)
    steps = lattice.steps if lattice else 0
    lights.coarseness = QUICK_COARSENESS
    if lattice:
        lattice.steps = min(steps, QUICK_STEPS)
    try:
        yield
    finally:
        lights.coarseness = 1.0
        if lattice:
            lattice.steps = steps


def solved_by(r: Renderer) -> tuple[Any, ...]:
    """What the solution of the renderer's scene depends on."""
    scene = r.scene
    parts = (
        scene.lights,
        scene.light_groups,
        scene.medium,
        scene.volumes,
        scene.environment,
        scene.meshes,
    )
    # Fog without bounds reaches to the camera where that stands outside the scene.
    fog = scene.medium
    place = scene.camera.position if fog is not None and fog.bounds is None else None
    if place is not None:
        low, high = scene.bounds
        place = None if np.all(place >= low) and np.all(place <= high) else place
    # Nested lattices follow the camera.
    nested = scene.camera if "cascades" in r.technique.stats else None
    # After an error the renderer recreates its resources, with nothing solved.
    return (r.technique, *parts, place, nested)


def is_same(now: tuple[Any, ...], before: tuple[Any, ...]) -> bool:
    """Whether nothing changed; scenes and their parts are compared by identity, they are frozen."""
    plain = (str, bool, float, tuple, Camera)
    return len(now) == len(before) and all(
        a is b or (isinstance(a, plain) and a == b) for a, b in zip(now, before, strict=True)
    )
