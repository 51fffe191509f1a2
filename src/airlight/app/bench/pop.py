"""What a frame of principal-ordinates propagation costs, under the stages' names of Elek2014.

Elek2014 Fig. 14: 64 ordinates of 20^3, 10 iterations, 800x600. The map turns from frame to frame,
so that no light is kept; in one case the medium moves, too.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .frames import WARM_UP_FRAMES, median_passes, spread, under_the_papers_names

if TYPE_CHECKING:
    from ...rendering import Renderer
    from ...scene.scene import Scene
    from ..progress import Report

SIZE, QUICK_SIZE = (800, 600), (48, 36)
SETTING: Mapping[str, Any] = {"ordinates": 64, "grid": 20, "iterations": 10}
PAPER_MS: Mapping[str, float] = {
    "importance": 5.0,
    "ordinates": 2.0,
    "initialisation": 2.0,
    "propagation": 12.0,
    "residuum": 2.0,
    "merge and upsampling": 4.0,
    "marching": 5.0,
}
"""Elek2014 Fig. 14, a GeForce GTX 770."""
STAGES: Mapping[str, tuple[str, ...]] = {
    "importance": ("pop importance",),
    "ordinates": ("pop ordinates",),
    "initialisation": ("pop density", "pop paths", "pop visibility", "pop initialisation"),
    "propagation": ("pop deposit", "pop propagation"),
    "residuum": ("pop diffuse", "pop residuum"),
    "merge and upsampling": ("pop merge", "pop emission", "upsample"),
    "marching": ("march",),
}
"""Our stages under the paper's names; delta-beam's deposits stand for propagation, its one solve
for the residuum."""
CASES: Mapping[str, Mapping[str, Any]] = {
    "delta-beam": {},
    "delta-beam, medium moving": {},
    "split": {"scheme": "split"},
    "paper": {"scheme": "paper"},
}
TURN_DEG = 0.5
Vary = Callable[["Scene", int], tuple["Scene", dict[str, Any]]]


def measure(adapter: str, report: Report, *, quick: bool = False) -> dict[str, Any]:
    """{"cases": [...], "growth": [{"axis", "rows"}], "paper_ms"}. Raises DeviceError."""
    from ...figures.pop_scenes import plume

    scene, size = plume(), QUICK_SIZE if quick else SIZE
    frames = 1 if quick else 5
    small = {"ordinates": 4, "grid": 6} if quick else {}
    # Frames whose parts change: what moves decides which stages run again.
    cases = []
    for index, (name, settings) in enumerate(list(CASES.items())[: 1 if quick else None]):
        report(f"pop: {name}", index / len(CASES))
        moves = name.endswith("moving")
        made = {**SETTING, **settings, **small}
        cases.append({"name": name, **_frames(scene, size, made, frames, adapter, moves=moves)})
    # Frames along one axis at a time, all else as in the paper's setting.
    growth = []
    for index, (axis, values, vary) in enumerate(_axes()[: 1 if quick else None]):
        report(f"pop: growth with {axis}", index / 3.0)
        rows = []
        for value in values[: 1 if quick else None]:
            varied, settings = vary(scene, value)
            made = {**SETTING, **settings, **small}
            rows.append({"value": value, **_frames(varied, size, made, frames, adapter)})
        growth.append({"axis": axis, "rows": rows})
    return {"size": list(size), "cases": cases, "growth": growth, "paper_ms": dict(PAPER_MS)}


def _axes() -> tuple[tuple[str, tuple[int, ...], Vary], ...]:
    return (
        ("ordinates", (8, 27, 64, 125), lambda scene, n: (scene, {"ordinates": n})),
        ("grid, cells a side", (8, 16, 20, 32), lambda scene, n: (scene, {"grid": n})),
        ("volume, voxels a side", (32, 64, 128), _with_voxels),
    )


def _with_voxels(scene: Scene, side: int) -> tuple[Scene, dict[str, Any]]:
    """The first volume's density repeated or thinned to side^3 voxels."""
    volume = scene.volumes[0]
    assert volume.density is not None
    # Voxels are repeated or skipped, whichever the size asks for.
    at = [np.minimum(np.arange(side) * n // side, n - 1) for n in volume.density.shape]
    density = np.ascontiguousarray(volume.density[np.ix_(*at)])
    made = dataclasses.replace(volume, density=density)
    return dataclasses.replace(scene, volumes=(made,)), {}


def moved(scene: Scene, step: int, *, moves: bool) -> Scene:
    """`step` frames on: the map turned, and where the medium `moves`, its voxels shifted."""
    assert scene.environment is not None
    # The map turns, so that no light from it can be reused.
    sky = dataclasses.replace(scene.environment, rotation_deg=TURN_DEG * step)
    scene = dataclasses.replace(scene, environment=sky)
    if not moves:
        return scene
    volume = scene.volumes[0]
    assert volume.density is not None
    density = np.roll(volume.density, step, axis=1)
    made = dataclasses.replace(volume, density=density)
    return dataclasses.replace(scene, volumes=(made,))


def _frames(
    scene: Scene,
    size: tuple[int, int],
    settings: Mapping[str, Any],
    frames: int,
    adapter: str,
    *,
    moves: bool = False,
) -> dict[str, Any]:
    """{frame_ms, python_ms, stages_ms, passes, settings, ...}."""
    from ...rendering import Renderer

    with Renderer(scene, "pop", size, settings=settings, adapter=adapter) as made:
        # Frames as they come, after those that compile and fill caches.
        for step in range(WARM_UP_FRAMES + frames):
            if step == WARM_UP_FRAMES:
                made.frame_ms.clear()
                made.python_ms.clear()
            made.scene = moved(scene, step, moves=moves)
            made.frame(read=False)
        # Stages in frames of their own: to wait for each costs time.
        timed = [_timed(made, scene, -1 - k, moves=moves) for k in range(min(frames, 3))]
        passes = median_passes(timed)
        stats = made.stats()
        return {
            "settings": dict(settings),
            "device": stats["device"],
            "grid": stats.get("grid"),
            "frame_ms": spread(made.frame_ms),
            "python_ms": spread(made.python_ms),
            "stages_ms": stages_of(passes),
            "passes": passes,
            "peak_gpu_bytes": stats["peak_gpu_bytes"],
        }


def _timed(made: Renderer, scene: Scene, step: int, *, moves: bool) -> dict[str, float]:
    made.scene = moved(scene, step, moves=moves)
    return made.timed_passes()


def stages_of(passes: Mapping[str, float]) -> dict[str, float]:
    """Milliseconds by the paper's stages; what has no name there is `other`."""
    ours = under_the_papers_names(passes, STAGES)
    return {**ours, "other": sum(passes.values()) - sum(ours.values())}
