"""The number of ordinates, chosen in different ways (Elek2014 Fig. 14)."""

from __future__ import annotations

from typing import Any

from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_7 import ways
from .pop_scenes import drawn, plume, scores, traced

ORDINATES = (8, 27, 64, 125, 216)


def draw(request: Request) -> Drawn:
    """The plume at g = 0.9: error and milliseconds of a frame by the number of ordinates."""
    scene = plume(0.9)
    truth = traced(request, scene)
    rows: list[Any] = []
    numbers: dict[str, Any] = {}
    stops: float | None = None
    for mode, extra in ways().items():
        pictures = []
        told = {}
        for index, count in enumerate(ORDINATES[: 2 if request.quick else None]):
            request.report(f"{count} ordinates", index / len(ORDINATES))
            image = drawn(request, scene, {"ordinates": count, **extra}, timed=True)
            stops = exposure_of(scene, image.radiance) if stops is None else stops
            pictures.append((f"{count} ordinates", image.radiance))
            told[str(count)] = {
                **scores(image, truth), "frame_ms": image.stats.get("frame_ms"),
            }  # fmt: skip
        rows.append((mode, exposed(request, pictures, stops or 0.0)))
        numbers[mode] = told
    if truth is not None:
        rows.append(("truth", exposed(request, [("Monte Carlo", truth.radiance)], stops or 0.0)))
    return Drawn(sheet(request, "More and more ordinates", rows), numbers)
