"""What prefiltering does to a thin, strongly forward-scattering medium (Elek2014 Fig. 6).

The sky's light that scatters once is left to the ordinates here, as in the paper: by default ours
is exact without them, and neither single ordinates nor what prefiltering does to them show.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_scenes import drawn, off, scores, slab, traced

ANISOTROPIES = (0.95, 0.98, 0.99, 0.999)

VARIANTS: Mapping[str, Mapping[str, Any]] = {
    "points": {"exact_sky": False, "prefilter": False},
    "prefiltered": {"exact_sky": False},
    "the default": {},
}


def draw(request: Request) -> Drawn:
    """A slab of optical depth 1.5: each ordinate a point; its part of the map; and the default."""
    # Sharper and sharper phase functions, by three ways to sum up ordinates.
    rows: dict[str, list[Any]] = {name: [] for name in (*VARIANTS, "Monte Carlo")}
    numbers: dict[str, Any] = {}
    chosen = ANISOTROPIES[:1] if request.quick else ANISOTROPIES
    stops = 0.0
    for index, g in enumerate(chosen):
        request.report(f"g = {g}", index / len(chosen))

        # The same slab by each of them, exposed by the first.
        scene = slab(g)
        truth = traced(request, scene)
        images = {name: drawn(request, scene, settings) for name, settings in VARIANTS.items()}
        if index == 0:
            stops = exposure_of(scene, images["prefiltered"].radiance)
        told = {name: scores(image, truth) for name, image in images.items()}
        for name, image in images.items():
            caption = f"g = {g}{off(told[name])}"
            rows[name] += exposed([(caption, image.radiance)], stops)
        if truth is not None:
            rows["Monte Carlo"] += exposed([(f"g = {g}", truth.radiance)], stops)
        numbers[f"g {g}"] = told

    # Without a truth its row is empty.
    kept = [(name, cells) for name, cells in rows.items() if cells]
    return Drawn(sheet(request, "Prefiltered ordinates", kept), numbers)
