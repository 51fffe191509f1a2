"""What each stage costs, under the names of Billeter2012 Table 1 and beside its numbers."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..app.bench.frames import median_passes, moved
from ..app.bench.tables import milliseconds
from ..maths.arrays import U8
from ..maths.transforms import F64
from ..scene.builtin import atrium_fog, haze_box
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from .panels import Drawn, Request, renderer
from .table import table_image

PAPER_MS: dict[str, tuple[float, float]] = {
    "reflected": (0.87, 0.84),
    "blockers": (4.5, 3.9),
    "single-scattered": (0.47, 0.58),
    "aggregate input": (0.02, 0.16),
    "prepare blockers": (0.40, 2.8),
    "propagate 8x": (1.49, 12.3),
    "copy results": (0.18, 1.24),
}
"""Billeter2012 Table 1, ms on a GTX 480, at 32^3 and 64^3."""
STAGES: dict[str, str] = {
    "reflected": "reflected",
    "blockers": "blockers",
    "single-scattered": "single-scattered",
    "aggregate input": "aggregate",
    "prepare blockers": "prepare blockers",
    "propagate 8x": "propagate",
    "copy results": "copy",
}
"""Our stages under the paper's names."""
SIDES = (32, 64)
LATTICE: Mapping[str, Any] = {"iterations": 8, "acceleration": "none", "map_resolution": 256}
STEP_M = 1e-4  # that surfaces are moved by, so that blockers are recomputed as in the paper


def draw(request: Request) -> Drawn:
    """The foggy atrium, its surfaces and its light moving: medians of a few frames."""
    scene, frames = (haze_box(), 1) if request.quick else (atrium_fog(), 5)
    sides = (8, 12) if request.quick else SIDES

    # Both of the paper's sizes.
    found: dict[int, dict[str, float]] = {}
    sizes: list[str] = []
    device = ""
    for side in sides:
        request.report(f"{side} cells", len(found) / len(sides))
        found[side], device, cells = measured(request, scene, side, frames)
        sizes.append(" x ".join(map(str, cells)))

    # Our stages under the paper's names.
    ours = {
        name: tuple(found[side].get(stage, 0.0) for side in sides) for name, stage in STAGES.items()
    }
    numbers = {
        "stages_ms": {"ours": ours, "paper": PAPER_MS},
        "device": device,
        "cells": list(sides),
        "lattices": sizes,
        "triangles": scene.triangle_count,
        "size": list(request.size),
        "passes": found,
    }
    return Drawn(_table(device, sizes, ours), numbers)


def measured(
    request: Request, scene: Scene, side: int, frames: int
) -> tuple[dict[str, float], str, list[int]]:
    """Milliseconds per stage with `side` cells along the longest side, the device, all sides."""
    # As the paper has it: all surfaces and the light move in every frame.
    settings = {**LATTICE, "resolution": side}
    with renderer(request, scene, settings, technique="lpv-scatter") as made:
        made.frame(read=False)
        told = []
        for step in range(1, frames + 1):
            lights = moved(scene.lights, step)
            made.scene = dataclasses.replace(made.scene, lights=lights)
            made.meshes.move(shifted(scene.meshes, STEP_M * step))
            told.append(made.timed_passes())
        stats = made.stats()
    return median_passes(told), str(stats["device"]), list(stats["lattice"])


def shifted(meshes: Sequence[Mesh], step_m: float) -> tuple[Mesh, ...]:
    """The meshes a little further along +x."""
    offset: F64 = np.zeros((4, 4))
    offset[0, 3] = step_m
    return tuple(
        dataclasses.replace(mesh, world_from_object=mesh.world_from_object + offset)
        for mesh in meshes
    )


def _table(device: str, sizes: Sequence[str], ours: Mapping[str, tuple[float, ...]]) -> U8:
    """The table as an image."""
    lines: list[tuple[str, ...]] = [
        ("Stage, ms", *(f"here {size}" for size in sizes), *(f"GTX480 {side}^3" for side in SIDES))
    ]
    for name, times in ours.items():
        lines.append((name, *(milliseconds(t) for t in (*times, *PAPER_MS[name]))))
    lines.append((device[:60],))
    return table_image(lines, (1,) * 5)
