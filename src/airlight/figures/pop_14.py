"""The number of ordinates, chosen in different ways (Elek2014 Fig. 14)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..scene.image import Image
from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_scenes import differences, drawn, moving_ms, off, plume, scores, traced

ORDINATES, MANY = (8, 27, 64, 216), 512
_SAMPLES: Mapping[str, Any] = {"ordinates_from": "importance", "exact_sky": False}
VARIANTS: Mapping[str, Mapping[str, Any]] = {
    "parts": {},
    "parts by what is seen": {"importance": "view"},
    "samples": _SAMPLES,
    "samples by importance": {**_SAMPLES, "importance": "view"},
}
"""The default, and what the paper does without importance and with it."""


def draw(request: Request) -> Drawn:
    """The plume at g = 0.9 by the number of ordinates: errors, what many change, a frame's time."""
    # The plume with a sharper phase function, and a truth of it.
    scene = plume(0.9)
    truth = traced(request, scene)
    rows: list[Any] = []
    numbers: dict[str, Any] = {"g": 0.9}
    stops = 0.0

    # What many ordinates make is the truth of the choice of few.
    best = drawn(request, scene, {"ordinates": MANY})

    # Each way to choose them, by their number.
    for row, (variant, settings) in enumerate(VARIANTS.items()):
        images: list[Any] = []
        told: dict[str, dict[str, Any]] = {}
        made: dict[str, Image] = {}
        for index, count in enumerate(ORDINATES[: 2 if request.quick else None]):
            done = row / len(VARIANTS) + index / len(VARIANTS) / len(ORDINATES)
            request.report(f"{variant}, {count} ordinates", done)
            made[str(count)] = image = drawn(request, scene, {"ordinates": count, **settings})

            # One exposure for the whole sheet.
            stops = exposure_of(scene, image.radiance) if not rows else stops
            found = scores(image, truth)
            told[str(count)] = dict(found)
            if row == 0:
                told[str(count)]["moving_ms"] = moving_ms(request, scene, {"ordinates": count})
            images.append((f"{count}{off(found)}", image.radiance))

        # Images, and below each how far it is from many ordinates.
        rows.append((variant, exposed(images, stops)))
        rows.append((f"beside {MANY}", differences(made, best)))
        numbers[variant] = told
    if truth is not None:
        rows.append(("truth", exposed([("Monte Carlo", truth.radiance)], stops)))
    return Drawn(sheet(request, "More and more ordinates", rows), numbers)
