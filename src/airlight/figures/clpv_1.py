"""The atrium, with the air clear and hazy (Kaplanyan2010 Fig. 1)."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..scene.builtin import atrium
from ..scene.checks import F32
from ..scene.medium import Medium, extinction_and_albedo
from ..scene.scene import Scene
from .panels import Drawn, Request, exposed, known, mean_light, rendered, sheet

WANTED: dict[str, Any] = {"cascades": 3, "resolution": 32}


def draw(request: Request) -> Drawn:
    """Direct light alone, clear air with `lpv` (three cascades), haze with `lpv-march`."""
    # The sheet begins with direct light alone, taken from the first image.
    panels: list[tuple[str, F32]] = []
    numbers: dict[str, Any] = {}
    clear = atrium()

    # Clear air, then haze; both by three nested lattices where the technique has them.
    for label, scene, technique in (
        ("with indirect light, 3 cascades", clear, "lpv"),
        ("haze, the lattice marched", in_haze(clear), "lpv-march"),
    ):
        request.report(label, len(panels) / 3.0)
        settings = {} if request.quick else known(technique, WANTED)
        image = rendered(request, scene, settings, technique=technique, timed=True)
        if not panels:
            panels.append(("direct light alone", image.layers["direct"]))
        panels.append((label, image.radiance))
        numbers[label] = {
            "technique": technique,
            "settings": settings,
            "triangles": scene.triangle_count,
            "frame_ms": image.stats["frame_ms"],
            "lattice": image.stats.get("lattice"),
            "mean_indirect": mean_light(image.layers["indirect"]),
            "mean_direct": mean_light(image.layers["direct"]),
        }

    # The scene's own exposure for all: haze is to look brighter.
    stops = clear.camera.exposure_stops or 0.0
    rows = [("atrium", exposed(panels, stops))]
    return Drawn(sheet(request, "Indirect light in the atrium", rows), numbers)


def in_haze(scene: Scene) -> Scene:
    """The scene full of white haze as builtin:atrium-fog."""
    sigma_t, albedo = extinction_and_albedo(0.03, 0.0)
    return dataclasses.replace(scene, medium=Medium(sigma_t, albedo=albedo))
