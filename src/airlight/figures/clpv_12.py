"""The lattice's spacing, and the number of iterations (Kaplanyan2010 Fig. 12).

The sun alone: the sky's light comes into all cells without an iteration. Below, hops are the
paper's, whose light moves a cell in each iteration, and no blockers stop it.
"""

from __future__ import annotations

import dataclasses
from typing import Any

from ..maths.colour import luminance
from ..scene.builtin import atrium, cornell
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Drawn, Request, away, exposed, exposure_of, mean_light, rendered, sheet

RESOLUTIONS = (8, 16, 32, 64)
ITERATIONS = (1, 4, 8, 16)


def draw(request: Request) -> Drawn:
    """Indirect light: above by cells a side, below by iterations (no occlusion, as the paper)."""
    scene = cornell() if request.quick else dataclasses.replace(atrium(), environment=None)

    # Iterations alone change the second row: nothing stops light, and no tail is added.
    rows = []
    numbers: dict[str, Any] = {"scene": scene.name}
    plain = {"occlusion": False, "bounces": False, "scheme": "paper", "tail": False}
    sides = RESOLUTIONS[:2] if request.quick else RESOLUTIONS
    for name, setting, values, fixed in (
        ("cells a side", "resolution", sides, {"iterations": 8}),
        ("iterations", "iterations", ITERATIONS, plain),
    ):
        # All values of one setting, the rest fixed.
        images: dict[int, Image] = {}
        for value in values:
            request.report(f"{value} {name}", len(images) / len(values))
            images[value] = rendered(request, scene, {**fixed, setting: value})
        numbers[name] = _told(scene, images)

        # Exposed by the last one, a stop brighter: indirect light alone is shown.
        stops = exposure_of(scene, images[values[-1]].radiance) + 1.0
        lit = [(str(v), image.layers["indirect"]) for v, image in images.items()]
        rows.append((name, exposed(lit, stops)))
    return Drawn(sheet(request, "Spacing and iterations", rows), numbers)


def _told(scene: Scene, images: dict[int, Image]) -> dict[str, Any]:
    """Per value: spacing, mean light, and the difference from the last one, relative L2."""
    # Relative to the image of the largest value.
    low, high = scene.bounds
    last = luminance(list(images.values())[-1].layers["indirect"])
    told = {}
    for value, image in images.items():
        light = luminance(image.layers["indirect"])
        lattice = image.stats["lattice"]
        told[str(value)] = {
            "lattice": lattice,
            "spacing_m": float((high - low).max() / (max(lattice) - 2)),
            "iterations": image.stats["iterations"],
            "mean_indirect": mean_light(image.layers["indirect"]),
            "from_the_last": away(light, last),
        }
    return told
