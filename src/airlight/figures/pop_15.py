"""Clouds with and without forward scattering (Elek2014 Fig. 15)."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..scene.scene import Scene
from .panels import Drawn, Request, exposed, exposure_of, from_here, sheet
from .pop_scenes import clouds, drawn, moving_ms, off, scores, traced

ANISOTROPIES = {"isotropic": 0.0, "g = 0.7": 0.7, "anisotropic, g = 0.96": 0.96}


def draw(request: Request) -> Drawn:
    """The builtin cloud, ours above and traced below, and against the sun; as fast for every g."""
    # The cloud with three phase functions.
    rows: dict[str, list[Any]] = {"ours": [], "Monte Carlo": [], "ours, against the sun": []}
    numbers: dict[str, Any] = {}
    for index, (name, g) in enumerate(ANISOTROPIES.items()):
        if request.quick and index:
            continue
        request.report(name, index / len(ANISOTROPIES))

        # Lit from the eye's side, beside its truth.
        scene = clouds(g)
        image = drawn(request, scene)
        truth = traced(request, scene)
        stops = exposure_of(scene, image.radiance)
        told = scores(image, truth)
        rows["ours"] += exposed([(f"{name}{off(told)}", image.radiance)], stops)
        if truth is not None:
            rows["Monte Carlo"] += exposed([(name, truth.radiance)], stops)

        # Against the sun, where forward scattering shows.
        shaded = against_the_sun(scene)
        behind = drawn(request, shaded)
        stops = exposure_of(shaded, behind.radiance)
        rows["ours, against the sun"] += exposed([(name, behind.radiance)], stops)
        numbers[name] = {**told, "moving_ms": moving_ms(request, scene)}
    kept = [(name, cells) for name, cells in rows.items() if cells]
    return Drawn(sheet(request, "Clouds", kept), numbers)


def against_the_sun(scene: Scene) -> Scene:
    """Seen from the ground on the other side, the sun behind the cloud's upper rim."""
    shaded = from_here(scene, (-68.0, 2.0, -35.0), (0.0, 46.0, 0.0), fov_y_deg=42.0)
    camera = dataclasses.replace(shaded.camera, exposure_stops=-3.1)
    return dataclasses.replace(shaded, camera=camera)
