"""Frames of a scene in steady state: how long they take, where, and in what memory."""

from __future__ import annotations

import dataclasses
import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ...scene.lights import DirectionalLight, Light

if TYPE_CHECKING:
    from ...rendering import Renderer
    from ...scene.camera import Camera
    from ...scene.scene import Scene

WARM_UP_FRAMES = 3  # shaders compiled, maps of what does not move drawn
TIMED_FRAMES = 3  # whose stages are waited for one by one
TURN_DEG = 0.25  # a directional light's turn about +Y from frame to frame
STEP_M = 0.01  # a local light's step, and the camera's
PAPER_LATTICE: Mapping[str, Any] = {"resolution": 32, "iterations": 8, "map_resolution": 256}
"""Kaplanyan2010 Table 1: one lattice of 32^3, 8 iterations, a 256^2 reflective shadow map."""


@dataclass(frozen=True)
class Case:
    """A scene to draw with a light that moves a little every frame."""

    name: str
    scene: str
    size: tuple[int, int]
    settings: Mapping[str, Any] = field(default_factory=lambda: dict(PAPER_LATTICE))
    technique: str = "lpv"


def spread(times_ms: Sequence[float]) -> dict[str, float]:
    """{median, min, runs} of a series."""
    return {
        "median": float(statistics.median(times_ms)),
        "min": float(min(times_ms)),
        "runs": len(times_ms),
    }


def median_passes(timed: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Milliseconds of each stage, of frames in which each was waited for."""
    names = dict.fromkeys(name for passes in timed for name in passes)
    return {n: float(statistics.median(p.get(n, 0.0) for p in timed)) for n in names}


def under_the_papers_names(
    passes: Mapping[str, float], stages: Mapping[str, Sequence[str]]
) -> dict[str, float]:
    """Milliseconds by a paper's `stages`, each of which may be several of ours."""
    return {k: sum(passes.get(name, 0.0) for name in ours) for k, ours in stages.items()}


def moved(lights: Sequence[Light], step: int) -> tuple[Light, ...]:
    """The lights `step` frames on: directional ones turned about +Y, local ones moved along +x."""
    return tuple(_moved(light, step) for light in lights)


def _moved(light: Light, step: int) -> Light:
    # A directional light has no place to move to, so it turns.
    if isinstance(light, DirectionalLight):
        c, s = np.cos(np.radians(TURN_DEG * step)), np.sin(np.radians(TURN_DEG * step))
        x, y, z = light.direction
        return dataclasses.replace(light, direction=(c * x + s * z, y, c * z - s * x))
    x, y, z = light.position
    return dataclasses.replace(light, position=(x + STEP_M * step, y, z))


def flown(camera: Camera, step: int) -> Camera:
    """The camera `step` frames on: moved along +x, looking the same way."""
    by_m = (STEP_M * step, 0.0, 0.0)
    x, y, z = np.add(camera.position, by_m).tolist()
    ahead_x, ahead_y, ahead_z = np.add(camera.target, by_m).tolist()
    return dataclasses.replace(camera, position=(x, y, z), target=(ahead_x, ahead_y, ahead_z))


def counted(renderer: Renderer) -> dict[str, dict[str, int]]:
    """What the passes of one more frame bind and run, by stage: {passes, invocations, nbytes}.

    Its camera and lights are moved, so that nothing is kept of the last.
    """
    from ...gpu.tally import Tally

    scene, commands, tally = renderer.scene, renderer.commands, Tally()
    # Recorded passes are replayed by the library and not counted, so recording is off for this
    # frame.
    with renderer.used():
        commands.tally, commands.is_recordable = tally, False
        try:
            renderer.frame(lights=moved(scene.lights, 1), camera=flown(scene.camera, 1), read=False)
            # The counted frame is none of those that are timed.
            renderer.frame_ms.pop()
            renderer.python_ms.pop()
        finally:
            commands.tally, commands.is_recordable = None, True
    return {name: dataclasses.asdict(count) for name, count in tally.stages.items()}


def measure(scene: Scene, case: Case, frames: int, adapter: str) -> dict[str, Any]:
    """Milliseconds per frame with the work finished on the device, its stages, and memory.

    {frame_ms, flying_ms, python_ms: spread; passes: {stage: median ms}; peak_gpu_bytes, lattice,
    cells (of all cascades),
    counts: as `counted`, ...}. The light moves; in `flying_ms` and `passes` the camera, too.
    Raises SettingsError, DeviceError.
    """
    from ...rendering import Renderer

    with Renderer(
        scene, case.technique, case.size, settings=case.settings, adapter=adapter
    ) as renderer:
        # Shaders are compiled and caches filled before anything counts.
        for step in range(WARM_UP_FRAMES):
            renderer.frame(lights=moved(scene.lights, step), read=False)
        renderer.frame_ms.clear()
        renderer.python_ms.clear()
        last = WARM_UP_FRAMES + frames
        # Frames as a user sees them, with the light alone in motion.
        for step in range(WARM_UP_FRAMES, last):
            renderer.frame(lights=moved(scene.lights, step), read=False)
        still_ms, python_ms = list(renderer.frame_ms), list(renderer.python_ms)
        # The same with a camera that flies.
        for step in range(last, last + frames):
            lights, camera = moved(scene.lights, step), flown(scene.camera, step - last + 1)
            renderer.frame(lights=lights, camera=camera, read=False)
        # Each stage waited for, in frames of their own: waiting costs time.
        timed = []
        for step in range(min(frames, TIMED_FRAMES)):
            lights, camera = moved(scene.lights, -step), flown(scene.camera, -step)
            renderer.scene = dataclasses.replace(renderer.scene, lights=lights, camera=camera)
            timed.append(renderer.timed_passes())
        counts = counted(renderer)
        # All of it with what the case was, so that a file of results stands alone.
        stats = renderer.stats()
        # Cells of all cascades; without any, those of the one lattice.
        lattices = [part["cells"] for part in stats.get("cascades", ())] or [stats["lattice"]]
        return {
            **{key: stats[key] for key in ("device", "adapter_type", "peak_gpu_bytes")},
            "first_image_s": stats["first_image_s"],
            **{key: stats[key] for key in ("lattice", "iterations", "triangles", "size")},
            "cells": sum(math.prod(count) for count in lattices),
            "scene": case.scene,
            "technique": case.technique,
            "settings": dict(case.settings),
            "frame_ms": spread(still_ms),
            "flying_ms": spread(renderer.frame_ms[frames:]),
            "python_ms": spread(python_ms),
            "counts": counts,
            "passes": median_passes(timed),
        }
