"""Ordinates where the picture needs them: importance from the camera (Elek2014 Fig. 7)."""

from __future__ import annotations

from typing import Any

from .panels import Drawn, Request, exposed, exposure_of, known, sheet
from .pop_scenes import drawn, errors, traced, white_plume

G, ORDINATES = 0.98, 27


def with_importance() -> dict[str, Any]:
    """The setting that turns importance propagation on, where the technique has it."""
    return known("pop", {"importance": True})


def draw(request: Request) -> Drawn:
    """27 ordinates for a medium of g = 0.98, without importance and with it."""
    scene = white_plume(G)
    truth = traced(request, scene)
    off = {name: False for name in with_importance()}
    pictures = {"without": drawn(request, scene, {"ordinates": ORDINATES, **off}).radiance}
    if with_importance():
        settings = {"ordinates": ORDINATES, **with_importance()}
        pictures["with importance"] = drawn(request, scene, settings).radiance
    if truth is not None:
        pictures["Monte Carlo"] = truth.radiance
    stops = exposure_of(scene, pictures["without"])
    told = {name: errors(p, truth) for name, p in pictures.items() if name != "Monte Carlo"}
    row = exposed(request, list(pictures.items()), stops)
    numbers = {"g": G, "ordinates": ORDINATES, "pictures": told}
    return Drawn(sheet(request, "Importance", [(f"{ORDINATES} ordinates", row)]), numbers)
