"""Fog lit many times, shafts alone, and no fog at all (Billeter2012 Fig. 1)."""

from __future__ import annotations

from typing import Any

from ..scene.builtin import atrium_fog, haze_box
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Drawn, Request, away, exposed, exposure_of, mean_light, rendered, sheet

TECHNIQUES = {
    "multiple scattering": "lpv-scatter",
    "single scattering": "single",
    "no air": "lpv",
}
SHAFTS = ("minmax", "volumes", "jitter")


def draw(request: Request) -> Drawn:
    """The foggy atrium by three techniques, and its shafts by three schemes, exposed alike."""
    # The same scene with all orders of scattering, one, and none.
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
    shafts = _shafts(request, scene, numbers)

    # Exposed by the first: what is missing looks dark.
    stops = exposure_of(scene, next(iter(images.values())).radiance)
    panels = [(label, image.radiance) for label, image in images.items()]
    schemes = [(label, image.radiance) for label, image in shafts.items()]
    rows = [
        (scene.name, exposed(panels, stops)),
        ("single scattering by", exposed(schemes, stops)),
    ]
    return Drawn(sheet(request, "Light scattered many times", rows), numbers)


def _shafts(request: Request, scene: Scene, numbers: dict[str, Any]) -> dict[str, Image]:
    """Light scattered once, by each scheme, full resolution; numbers["shafts"] is filled.

    `off_minmax`: relative L2 of the shafts' layer from that of minmax.
    """
    # Every scheme beside the exact one, at full resolution.
    numbers["shafts"] = {}
    images: dict[str, Image] = {}
    for scheme in SHAFTS:
        request.report(f"shafts by {scheme}", len(images) / len(SHAFTS))
        settings = {"shafts": scheme, "shaft_resolution": "full"}
        image = rendered(request, scene, settings, technique="single", timed=True)
        images[scheme] = image
        lit, exact = (i.layers["single_scatter"] for i in (image, images["minmax"]))
        numbers["shafts"][scheme] = {
            "frame_ms": image.stats["frame_ms"],
            "off_minmax": away(lit, exact),
        }
    return images
