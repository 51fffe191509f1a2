"""How the cost of a frame grows: cells, iterations, map size, lights, triangles, cascades."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...scene.lights import Light, PointLight
from .frames import PAPER_LATTICE, Case, measure

if TYPE_CHECKING:
    from ...scene.scene import Scene

Vary = Callable[["Scene", int], tuple["Scene", Mapping[str, Any]]]
"""(scene, value) -> the scene and the settings at that value."""

SCENE = "builtin:room"
SCENE_OF_MANY_TRIANGLES = "builtin:atrium"


@dataclass(frozen=True)
class Axis:
    """What varies, over which values, on which scene."""

    name: str
    values: tuple[int, ...]
    vary: Vary
    scene: str = SCENE
    setting: str = ""

    def is_known(self, settings: object) -> bool:
        """Whether the technique has the setting that varies."""
        names = {f.name for f in dataclasses.fields(settings)}  # type: ignore[arg-type]
        return not self.setting or self.setting in names


def _of_setting(name: str) -> Vary:
    return lambda scene, value: (scene, {name: value})


def axes(*, is_long: bool = False) -> tuple[Axis, ...]:
    """Every table of growth; `is_long`: up to five million triangles."""
    thousands = (100, 300, 1000, *((3000, 5000) if is_long else ()))
    return (
        Axis("cells a side", (16, 24, 32, 48, 64), _of_setting("resolution")),
        Axis("iterations", (1, 8, 16, 32, 64), _of_setting("iterations")),
        Axis("map side, px", (64, 128, 256, 512), _of_setting("map_resolution")),
        Axis("point lights", (1, 2, 4, 8), _with_lights),
        Axis("share of triangles, 1/n", (8, 4, 2, 1), _with_fewer_meshes, SCENE_OF_MANY_TRIANGLES),
        Axis("thousand triangles", thousands, _with_ground),
        Axis("cascades", (1, 2, 3), _of_setting("cascades"), SCENE_OF_MANY_TRIANGLES, "cascades"),
    )


def point_lights(scene: Scene, count: int) -> tuple[Light, ...]:
    """`count` point lights on a line through the middle of the scene, 1 W/sr in all."""
    low, high = scene.bounds
    # At equal distances from each other and from the walls, above the middle.
    share = (np.arange(count) + 1.0) / (count + 1.0)
    along = low + (high - low) * np.stack([share, np.full(count, 0.6), np.full(count, 0.5)], 1)
    power = 1.0 / count
    return tuple(
        PointLight((float(x), float(y), float(z)), (power, power, power)) for x, y, z in along
    )


def _with_lights(scene: Scene, value: int) -> tuple[Scene, Mapping[str, Any]]:
    return dataclasses.replace(scene, lights=point_lights(scene, value)), {}


def _with_ground(scene: Scene, value: int) -> tuple[Scene, Mapping[str, Any]]:
    """The scene on hilly ground of `value` thousand triangles, in one mesh."""
    from ...scene.mesh import Geometry, Mesh

    (x0, y0, z0), (x1, _, z1) = scene.bounds
    # A lattice of n x n points has about 2 n^2 triangles.
    side = round(math.sqrt(500.0 * value)) + 1
    x, z = np.meshgrid(np.linspace(x0, x1, side), np.linspace(z0, z1, side))
    # Gentle hills, so that triangles face various ways.
    y = y0 + 0.05 * np.sin(9.0 * x) * np.cos(7.0 * z)
    at = np.arange(side * side, dtype=np.uint32).reshape(side, side)
    # The four corners of each square, which two triangles fill.
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[:-1, 1:], at[1:, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([c, b, d], 1)])
    ground = Geometry(np.stack([x, y, z], -1).reshape(-1, 3).astype(np.float32), triangles)
    return dataclasses.replace(scene, meshes=(*scene.meshes, Mesh(ground))), {}


def _with_fewer_meshes(scene: Scene, value: int) -> tuple[Scene, Mapping[str, Any]]:
    return dataclasses.replace(scene, meshes=scene.meshes[::value]), {}


def table(
    axis: Axis,
    scene: Scene,
    size: tuple[int, int],
    frames: int,
    adapter: str,
    base: Mapping[str, Any] = PAPER_LATTICE,
) -> dict[str, Any]:
    """{"axis", "scene", "rows": [{value, cells, triangles, flying_ms, passes, ...}]}.

    `base` are the settings that do not vary.
    """
    rows = []
    # One setting varies, all else stays as the paper's lattice has it.
    for value in axis.values:
        varied, settings = axis.vary(scene, value)
        case = Case(axis.name, axis.scene, size, {**base, **settings})
        found = measure(varied, case, frames, adapter)
        rows.append(
            {
                "value": value,
                "cells": found["cells"],
                "triangles": found["triangles"],
                "flying_ms": found["flying_ms"],
                "passes": found["passes"],
                "peak_gpu_bytes": found["peak_gpu_bytes"],
                "first_image_s": found.get("first_image_s"),
            }
        )
    return {"axis": axis.name, "scene": axis.scene, "size": list(size), "rows": rows}
