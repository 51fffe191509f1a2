"""Where light in the air comes from: bounced alone, seen in the air, and its beam (Fig. 2).

As in Billeter2012 Fig. 2 the lattice carries what surfaces reflect, and nothing else.
"""

from __future__ import annotations

from typing import Any

from ..scene.builtin import haze_box
from ..scene.checks import F32
from .panels import Drawn, Request, exposed, exposure_of, mean_light, rendered, sheet


def draw(request: Request) -> Drawn:
    """The box of haze: its surfaces, with the marched lattice, and with single scattering."""
    # Layers are added one by one, so that each image shows what one of them brings.
    scene = haze_box()
    request.report("haze", 0.0)
    image = rendered(request, scene, {"single": "off"}, technique="lpv-scatter")
    layers = image.layers
    sums: list[tuple[str, F32]] = [("lattice on surfaces", layers["direct"] + layers["indirect"])]
    for label, name in (("and in the air", "multiple_scatter"), ("and its beam", "single_scatter")):
        sums.append((label, sums[-1][1] + layers[name]))
    stops = exposure_of(scene, image.radiance)
    numbers: dict[str, Any] = {
        "scene": scene.name,
        "mean_radiance": {label: mean_light(light) for label, light in sums},
    }
    rows = [(scene.name, exposed(sums, stops))]
    return Drawn(sheet(request, "Where light in the air comes from", rows), numbers)
