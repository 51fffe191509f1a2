"""Media and surfaces together: shadows on both, and light from one to the other (Fig. 17)."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from ..scene.builtin import smoke
from .panels import QUICK, Drawn, Request, exposed, exposure_of, known, rendered, sheet
from .pop_scenes import QUICK_POP, errors, traced

VARIANTS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "pop": ("pop", {}),
    "pop, no light from surfaces": ("pop", {"virtual_lights": 0}),
    "auto: with all bounces": ("auto", {}),
}


def draw(request: Request) -> Drawn:
    """The builtin smoke in its court: ours, without surfaces' light, with bounces, and alone."""
    # Light from surfaces to the medium and back, less and more of it.
    scene = smoke()
    truth = traced(request, scene)
    images = {}
    for index, (name, (technique, settings)) in enumerate(VARIANTS.items()):
        request.report(name, index / len(VARIANTS))
        quick = known(technique, {**QUICK, **QUICK_POP}) if request.quick else {}
        images[name] = rendered(request, scene, {**quick, **settings}, technique=technique)

    # The medium alone, which shows what surfaces bring to it.
    alone = dataclasses.replace(scene, meshes=())
    quick = dict(QUICK_POP) if request.quick else {}
    images["pop, medium alone"] = rendered(request, alone, quick, technique="pop")
    stops = exposure_of(scene, images["pop"].radiance)

    # Errors of the whole, and how much light media scatter in each.
    numbers: dict[str, Any] = {name: errors(images[name].radiance, truth) for name in VARIANTS}
    told = {
        name: float(i.layers["scattered"].mean())
        for name, i in images.items()
        if "scattered" in i.layers
    }
    numbers["mean_scattered"] = told
    cells: list[Any] = [(name, image.radiance) for name, image in images.items()]
    if truth is not None:
        cells.insert(3, ("Monte Carlo", truth.radiance))
    rows = [("smoke", exposed(part, stops)) for part in (cells[:2], cells[2:4], cells[4:])]
    return Drawn(sheet(request, "Smoke and surfaces", [r for r in rows if r[1]]), numbers)
