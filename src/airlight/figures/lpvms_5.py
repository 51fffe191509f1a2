"""Six ways to draw a foggy scene (Billeter2012 Fig. 5 a to f)."""

from __future__ import annotations

from typing import Any

from ..app.compare.images import shown
from ..reference.metrics import compare
from ..scene.builtin import atrium_fog, haze_box
from ..scene.image import Image
from .panels import Drawn, Request, exposed, exposure_of, mean_light, rendered, sheet
from .truths import as_large_as, told_of, truth_of, without_grain

TECHNIQUES = {
    "a  ours": "lpv-scatter",
    "b  shadow map": "direct",
    "c  lattice": "lpv",
    "d  single scattering": "single",
    "e  marched lattice": "lpv-march",
    "f  d and e": "lpv-sum",
}


def draw(request: Request) -> Drawn:
    """Six techniques in the papers' order, exposed alike; scores where a truth is traced."""
    scene = haze_box() if request.quick else atrium_fog()
    truth = truth_of(request, scene)
    images: dict[str, Image] = {}
    numbers: dict[str, Any] = {"scene": scene.name, "techniques": {}}
    for label, technique in TECHNIQUES.items():
        request.report(label, len(images) / len(TECHNIQUES))
        images[label] = image = rendered(request, scene, technique=technique)
        told: dict[str, Any] = {"technique": technique, "mean": mean_light(image.radiance)}
        if truth is not None:
            found = compare(as_large_as(image, truth.image.radiance), truth.image)
            told |= {
                name: found[name]
                for name in ("relmse", "relative_l2", "flip", "hdr_flip", "energy_ratio")
            }
        numbers["techniques"][label] = told
    stops = exposure_of(scene, next(iter(images.values())).radiance)
    panels = exposed(request, [(name, image.radiance) for name, image in images.items()], stops)
    rows: list[Any] = [("", panels[:3]), ("", panels[3:])]
    if truth is not None:
        light = without_grain(truth, next(iter(images.values())))
        rows.append(("", [(told_of(truth), shown(light, stops))]))
    return Drawn(sheet(request, "Six ways to draw fog", rows), numbers)
