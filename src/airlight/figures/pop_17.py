"""Media and surfaces together: shadows on both, and light from one to the other (Fig. 17)."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..scene.builtin import smoke
from .panels import Drawn, Request, exposed, exposure_of, known, rendered, sheet
from .pop_scenes import QUICK_POP, errors, traced


def draw(request: Request) -> Drawn:
    """The builtin smoke in its court: whole, without surfaces' bounce, and alone."""
    scene = smoke()
    truth = traced(request, scene)
    alone = dataclasses.replace(scene, meshes=())
    bounce = known("pop", {"virtual_lights": 0})
    quick = QUICK_POP if request.quick else {}
    pictures = {"whole": rendered(request, scene, quick, technique="pop")}
    if bounce:
        settings = {**quick, **bounce}
        pictures["no light from surfaces"] = rendered(request, scene, settings, technique="pop")
    pictures["medium alone"] = rendered(request, alone, quick, technique="pop")
    stops = exposure_of(scene, pictures["whole"].radiance)
    cells: list[Any] = [(name, image.radiance) for name, image in pictures.items()]
    if truth is not None:
        cells.append(("Monte Carlo", truth.radiance))
    numbers: dict[str, Any] = {"whole": errors(pictures["whole"].radiance, truth)}
    scattered = {name: float(i.layers["scattered"].mean()) for name, i in pictures.items()}
    numbers["mean_scattered"] = scattered
    row = [("smoke", exposed(request, cells, stops))]
    return Drawn(sheet(request, "Smoke and surfaces", row), numbers)
