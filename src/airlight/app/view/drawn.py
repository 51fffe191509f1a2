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
from ...scene.fingerprint import is_same
from ...scene.scene import Scene

QUICK_COARSENESS = 2.0
"""How much larger the texels of directional lights' shadow maps are, as pixels are then."""
QUICK_STEPS = 32
"""The fewest with an estimate of what later ones would add: living room, .86 of 64 steps' light."""
LATTICE_SHARE = 0.2
"""Of the time while a hand moves a light: what lattices may take on a CPU adapter."""
_LIGHTS = (1, 2, 5)  # of `solved_by`: lights, their groups, the environment


class Drawn:
    """For one thread at a time. `solve_ms`: the time of the last `solve` on a CPU adapter.

    `is_quick`: whether the present solution was found quickly.
    """

    def __init__(self, renderer: Renderer) -> None:
        self.renderer = renderer
        self.solve_ms = 0.0
        self._solved: tuple[Any, ...] = ()
        self.is_quick = False
        self._lattices_ms, self._lattices_s = 0.0, 0.0  # what they took last, and when that was

    def give(self, scene: Scene) -> None:
        """Show `scene`, which has the structure of the one the renderer was made for."""
        self.renderer.show(scene)

    def solve(self, commands: Commands, *, is_quick: bool = False, is_still: bool = False) -> None:
        """All that is not drawn for the view, unless nothing has changed that it depends on.

        `is_quick`: a hand moves what shines, and fewer steps of propagation and coarser shadows
        will do for now on a CPU adapter, and lattices lag: direct light follows the hand at once,
        indirect light when there is time. What was solved so is solved again where it is not.
        `is_still`: for an image of several samples, as always or never of this renderer.
        """
        # Nothing to do while lights, geometry and media are as they were solved.
        self.solve_ms = 0.0
        r = self.renderer
        now = solved_by(r)
        if is_same(now, self._solved) and (is_quick or not self.is_quick):
            return
        begin = time.perf_counter()
        was_quick, self.is_quick = self.is_quick, is_quick and r.gpu.is_cpu
        # Lattices may lag while lights are moved: they get LATTICE_SHARE of the time.
        lags = self.is_quick and _are_lights(now, self._solved)
        # A hand that begins to move lights starts the clock.
        if lags and not was_quick:
            self._lattices_s = begin
        wait_s = self._lattices_ms * 1e-3 * (1.0 / LATTICE_SHARE - 1.0)
        lags &= begin - self._lattices_s < wait_s
        with _quickly(r) if self.is_quick else nullcontext():
            r.technique.solve(commands, r.show(r.scene), is_still=is_still, lags=lags)
        self._solved = now
        # What solving took decides when the lattices follow next.
        if r.gpu.is_cpu:
            commands.submit()
            r.gpu.wait()
            end = time.perf_counter()
            self.solve_ms = (end - begin) * 1e3
            if not lags:
                self._lattices_ms, self._lattices_s = self.solve_ms, end

    def finish(self, scene: Scene) -> None:
        """Solve `scene` wholly where that was not done yet: other views may show it then."""
        r = self.renderer
        with r.used(), r.whole():
            self.give(scene)
            self.solve(r.commands)
            r.commands.submit()

    def draw(
        self,
        commands: Commands,
        camera: Camera,
        jitter_px: tuple[float, float],
        sample: int,
        jitter: tuple[int, int] = (0, 1),
    ) -> None:
        """The layers of one image from `camera`; `jitter`: which of its sample's, of how many."""
        r = self.renderer
        r.aim(camera, jitter_px, sample, jitter)
        r.technique.draw(commands, r.view)

    def close(self) -> None:
        """Give the device's memory back."""
        self.renderer.close()


@contextmanager
def _quickly(r: Renderer) -> Iterator[None]:
    """A context with coarser shadow maps, and no more than QUICK_STEPS steps of propagation."""
    # While a light is dragged shadows and propagation cost most, and are missed least.
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
    # Parts that light depends on, by identity.
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
    # What closed walls hide from the eye is dark.
    hidden = r.technique.kit.hidden(scene)
    # After an error the renderer recreates its resources, with nothing solved.
    return (r.technique, *parts, place, nested, hidden)


def _are_lights(now: tuple[Any, ...], before: tuple[Any, ...]) -> bool:
    """Whether nothing but lights and sky has changed since there was a solution."""
    # All but the lights and the sky have to be the same objects.
    others = [i for i in range(len(now)) if i not in _LIGHTS]
    return len(before) == len(now) and is_same(
        tuple(now[i] for i in others), tuple(before[i] for i in others)
    )
