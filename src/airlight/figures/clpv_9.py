"""A polished floor that reflects what the lattice holds (Kaplanyan2010 Fig. 9)."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..app.compare_pictures import shown
from ..scene.builtin import cornell
from ..scene.builtin.patch import Finish, placed_at
from ..scene.builtin.solids import rectangle
from ..scene.material import Material
from ..scene.scene import Scene
from .clpv_6 import scores, truth_of
from .panels import Drawn, Request, exposure_of, mean_light, rendered, sheet

ROUGHNESSES = (0.1, 0.3, 0.6)
_ABOVE_M = 0.004  # of the box's own floor


def draw(request: Request) -> Drawn:
    """A column per roughness of a metal floor in the Cornell box; below, path traced."""
    ours, traced = [], []
    numbers: dict[str, Any] = {"scene": "cornell", "roughness": {}}
    for roughness in ROUGHNESSES:
        request.report(f"roughness {roughness}", roughness)
        scene = with_metal_floor(roughness)
        image = rendered(request, scene)
        stops, label = exposure_of(scene, image.radiance), f"roughness {roughness}"
        ours.append((label, shown(image.radiance, stops)))
        told = {"mean_indirect": mean_light(image.layers["indirect"])}
        truth = truth_of(request, scene)
        if truth is not None:
            traced.append((label, shown(truth.image.radiance, stops)))
            told |= scores(image.layers["indirect"], truth.image.layers["indirect"])
        numbers["roughness"][str(roughness)] = told
    rows = [("lpv", ours), *([("path traced", traced)] if traced else [])]
    return Drawn(sheet(request, "A polished metal floor", rows), numbers)


def with_metal_floor(roughness: float) -> Scene:
    """The Cornell box with a sheet of metal on its floor."""
    box = cornell()
    metal = Material(name="metal", base_color=(0.9, 0.9, 0.9), roughness=roughness, metallic=1.0)
    sheet_ = rectangle((-2.7, _ABOVE_M, -2.7), (5.4, 0.0, 0.0), (0.0, 0.0, 5.4))
    floor = Finish(metal).meshes(sheet_, [placed_at(0.0, 0.0, 0.0)], "metal floor")
    return dataclasses.replace(box, name="cornell-metal", meshes=(*box.meshes, *floor))
