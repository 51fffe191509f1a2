"""Fog lit many times, shafts alone, and no fog at all (Billeter2012 Fig. 1)."""

from __future__ import annotations

from typing import Any

from ..scene.builtin import atrium_fog, haze_box
from ..scene.image import Image
from .panels import Drawn, Request, exposed, exposure_of, mean_light, rendered, sheet

TECHNIQUES = {
    "multiple scattering": "lpv-scatter", "single scattering": "single", "no air": "lpv",
}  # fmt: skip


def draw(request: Request) -> Drawn:
    """The foggy atrium by three techniques, exposed alike."""
    scene = haze_box() if request.quick else atrium_fog()
    images: dict[str, Image] = {}
    numbers: dict[str, Any] = {"scene": scene.name, "techniques": {}}
    for label, technique in TECHNIQUES.items():
        request.report(label, len(images) / len(TECHNIQUES))
        images[label] = image = rendered(request, scene, technique=technique, timed=True)
        numbers["techniques"][label] = {
            "technique": technique,
            "mean_radiance": mean_light(image.radiance),
            "frame_ms": image.stats["frame_ms"],
        }
    stops = exposure_of(scene, next(iter(images.values())).radiance)
    panels = [(label, image.radiance) for label, image in images.items()]
    rows = [(scene.name, exposed(request, panels, stops))]
    return Drawn(sheet(request, "Light scattered many times", rows), numbers)
