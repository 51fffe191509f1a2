"""Clouds with and without forward scattering (Elek2014 Fig. 15)."""

from __future__ import annotations

from typing import Any

from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_scenes import clouds, drawn, scores, traced

ANISOTROPIES = {"isotropic": 0.0, "g = 0.7": 0.7, "anisotropic, g = 0.96": 0.96}


def draw(request: Request) -> Drawn:
    """The builtin cloud, ours above and traced below; as fast for every g."""
    rows: dict[str, list[Any]] = {"ours": [], "Monte Carlo": []}
    numbers: dict[str, Any] = {}
    for index, (name, g) in enumerate(ANISOTROPIES.items()):
        if request.quick and index:
            continue
        request.report(name, index / len(ANISOTROPIES))
        scene = clouds(g)
        image = drawn(request, scene, timed=True)
        truth = traced(request, scene)
        stops = exposure_of(scene, image.radiance)
        rows["ours"] += exposed(request, [(name, image.radiance)], stops)
        if truth is not None:
            rows["Monte Carlo"] += exposed(request, [(name, truth.radiance)], stops)
        told = scores(image, truth)
        numbers[name] = {**told, "frame_ms": image.stats.get("frame_ms")}
    kept = [(name, cells) for name, cells in rows.items() if cells]
    return Drawn(sheet(request, "Clouds", kept), numbers)
