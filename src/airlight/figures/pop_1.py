"""Smoke under a complex map, nothing computed ahead (Elek2014 Fig. 1)."""

from __future__ import annotations

from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_scenes import drawn, scores, traced, white_plume


def draw(request: Request) -> Drawn:
    """Dense smoke, g = 0.85, no absorption, from two sides of the map; the first also traced."""
    scene = white_plume(0.85)
    image = drawn(request, scene, timed=True)
    truth = traced(request, scene)
    stops = exposure_of(scene, image.radiance)
    shown = [("64 ordinates of 20^3", image.radiance)]
    if truth is not None:
        shown.append(("Monte Carlo", truth.radiance))
    numbers = {
        "frame_ms": image.stats.get("frame_ms"), "device": image.stats.get("device"),
        "medium": {"g": 0.85, "albedo": 1.0}, **scores(image, truth),
    }  # fmt: skip
    return Drawn(sheet(request, "Smoke", [("smoke", exposed(request, shown, stops))]), numbers)
