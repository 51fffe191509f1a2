"""A polished floor that reflects what the lattice holds (Kaplanyan2010 Fig. 9)."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..app.compare.images import shown
from ..scene.builtin import cornell
from ..scene.builtin.patch import Finish
from ..scene.builtin.solids import rectangle
from ..scene.material import Material
from ..scene.scene import Scene
from .clpv_6 import scores
from .panels import Drawn, Request, exposure_of, from_here, mean_light, rendered, sheet
from .truths import smoothed, truth_of

ROUGHNESSES = (0.1, 0.3, 0.6)
_ABOVE_M = 0.004  # of the box's own floor


def draw(request: Request) -> Drawn:
    """A column per roughness of a dark polished floor in the Cornell box; below, path traced."""
    ours, traced = [], []
    numbers: dict[str, Any] = {"scene": "cornell", "roughness": {}}

    # For each roughness ours, and a path tracer's image smoothed in its indirect light alone.
    for roughness in ROUGHNESSES:
        request.report(f"roughness {roughness}", roughness)
        scene = with_polished_floor(roughness)
        image = rendered(request, scene)
        stops, label = exposure_of(scene, image.radiance), f"roughness {roughness}"
        ours.append((label, shown(image.radiance, stops)))
        told = {"mean_indirect": mean_light(image.layers["indirect"])}
        truth = truth_of(request, scene)
        if truth is not None:
            light = truth.image.layers["indirect"]
            smooth = truth.image.radiance - light + smoothed(light, image, radius_px=2)
            traced.append((label, shown(smooth, stops)))
            told |= scores(image.layers["indirect"], truth.image.layers["indirect"])
        numbers["roughness"][str(roughness)] = told
    rows = [("lpv", ours), *([("path traced, smoothed", traced)] if traced else [])]
    return Drawn(sheet(request, "A polished floor", rows), numbers)


def with_polished_floor(roughness: float) -> Scene:
    """The Cornell box with a sheet of dark polished stone on its floor, seen from lower.

    Half of what falls on it is mirrored, half is absorbed or scattered: light that a metal mirrors
    falls elsewhere than what a lattice takes for scattered.
    """
    # A sheet a little above the box's floor, nearer to a metal than to a wall.
    box = cornell()
    stone = Material(name="stone", base_color=(0.45, 0.45, 0.45), roughness=roughness, metallic=0.6)
    sheet_ = rectangle((-2.7, _ABOVE_M, -2.7), (5.4, 0.0, 0.0), (0.0, 0.0, 5.4))
    floor = Finish(stone).meshes(sheet_, "polished floor")
    scene = dataclasses.replace(box, name="cornell-polished", meshes=(*box.meshes, *floor))
    return from_here(scene, (-0.6, 2.6, 8.2), (0.0, 1.3, 0.0), fov_y_deg=36.0)
