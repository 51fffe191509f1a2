"""The atrium without occlusion, with it, and with further bounces (Kaplanyan2010 Fig. 7)."""

from __future__ import annotations

from typing import Any

from ..scene.builtin import atrium, cornell
from ..scene.image import Image
from .panels import Drawn, Request, exposed, exposure_of, mean_light, rendered, sheet

MODES: dict[str, dict[str, bool]] = {
    "no occlusion": {"occlusion": False, "bounces": False},
    "occlusion": {"occlusion": True, "bounces": False},
    "occlusion and bounces": {"occlusion": True, "bounces": True},
}


def draw(request: Request) -> Drawn:
    """Whole images above, indirect light alone below."""
    # Alike but for what stands in light's path.
    scene = cornell() if request.quick else atrium()
    images: dict[str, Image] = {}
    numbers: dict[str, Any] = {"scene": scene.name, "modes": {}}
    for label, mode in MODES.items():
        request.report(label, len(images) / len(MODES))
        images[label] = image = rendered(request, scene, mode, timed=True)
        numbers["modes"][label] = {
            "mean_indirect": mean_light(image.layers["indirect"]),
            "frame_ms": image.stats["frame_ms"],
            "iterations": image.stats["iterations"],
        }

    # Exposed alike: what is lost to occlusion looks dark.
    stops = exposure_of(scene, next(iter(images.values())).radiance)
    whole = [(label, image.radiance) for label, image in images.items()]
    alone = [(label, image.layers["indirect"]) for label, image in images.items()]
    rows = [
        ("all light", exposed(whole, stops)),
        ("indirect light", exposed(alone, stops)),
    ]
    return Drawn(sheet(request, "What stands in the light's way", rows), numbers)
