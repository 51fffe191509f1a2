"""The number of ordinates, with and without importance (Elek2014 Fig. 14)."""

from __future__ import annotations

from typing import Any

from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_7 import with_importance
from .pop_scenes import drawn, errors, plume, traced

ORDINATES = (8, 27, 64, 125, 216)


def draw(request: Request) -> Drawn:
    """The plume at g = 0.9: error and milliseconds of a frame by the number of ordinates."""
    scene = plume(0.9)
    truth = traced(request, scene)
    modes: dict[str, dict[str, Any]] = {"even": {name: False for name in with_importance()}}
    if with_importance():
        modes["by importance"] = with_importance()
    rows: list[Any] = []
    numbers: dict[str, Any] = {}
    stops: float | None = None
    for mode, extra in modes.items():
        pictures = []
        told = {}
        for index, count in enumerate(ORDINATES[: 2 if request.quick else None]):
            request.report(f"{count} ordinates", index / len(ORDINATES))
            image = drawn(request, scene, {"ordinates": count, **extra}, timed=True)
            stops = exposure_of(scene, image.radiance) if stops is None else stops
            pictures.append((f"{count} ordinates", image.radiance))
            told[str(count)] = errors(image.radiance, truth) | {
                "frame_ms": image.stats.get("frame_ms")
            }
        rows.append((mode, exposed(request, pictures, stops or 0.0)))
        numbers[mode] = told
    if truth is not None:
        rows.append(("truth", exposed(request, [("Monte Carlo", truth.radiance)], stops or 0.0)))
    return Drawn(sheet(request, "More and more ordinates", rows), numbers)
