"""Smoke under a complex map, nothing computed ahead (Elek2014 Fig. 1)."""

from __future__ import annotations

from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_scenes import drawn, moving_ms, off, scores, traced, turned, white_plume

OTHER_SIDE_DEG = 180.0  # the map is turned, not the plume: the sun at the eye's back


def draw(request: Request) -> Drawn:
    """Dense smoke, g = 0.85, no absorption, before two sides of the map; the first also traced."""
    # White smoke before the sun's side of the map, and its truth.
    scene = white_plume(0.85)
    image = drawn(request, scene)
    truth = traced(request, scene)
    stops = exposure_of(scene, image.radiance)
    told = scores(image, truth)
    shown = [(f"64 ordinates of 20^3{off(told)}", image.radiance)]
    if truth is not None:
        shown.append(("Monte Carlo", truth.radiance))

    # The map turned instead of the camera: the smoke is lit from the eye's side.
    other = drawn(request, turned(scene, OTHER_SIDE_DEG))
    shown.append(("against the other side", other.radiance))
    numbers = {
        "moving_ms": moving_ms(request, scene),
        "device": image.stats.get("device"),
        "medium": {"g": 0.85, "albedo": 1.0},
        **told,
    }
    return Drawn(sheet(request, "Smoke", [("smoke", exposed(shown, stops))]), numbers)
