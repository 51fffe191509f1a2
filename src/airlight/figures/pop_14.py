"""The number of ordinates, chosen in different ways (Elek2014 Fig. 14)."""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from typing import Any

from ..scene.scene import Scene
from .panels import TIMED_FRAMES, Drawn, Request, exposed, exposure_of, renderer, sheet
from .pop_scenes import QUICK_POP, drawn, off, plume, scores, traced, turned

ORDINATES = (8, 27, 64, 216)
_SAMPLES: Mapping[str, Any] = {"ordinates_from": "importance", "exact_sky": False}
WAYS: Mapping[str, Mapping[str, Any]] = {
    "parts": {},
    "parts by what is seen": {"importance": "view"},
    "samples": _SAMPLES,
    "samples by importance": {**_SAMPLES, "importance": "view"},
}
"""The default, and what the paper does without importance and with it."""


def draw(request: Request) -> Drawn:
    """The plume at g = 0.9 by the number of ordinates: errors, and how long a frame takes."""
    scene = plume(0.9)
    truth = traced(request, scene)
    rows: list[Any] = []
    numbers: dict[str, Any] = {"g": 0.9}
    stops = 0.0
    for row, (way, settings) in enumerate(WAYS.items()):
        pictures: list[Any] = []
        told: dict[str, dict[str, Any]] = {}
        for index, count in enumerate(ORDINATES[: 2 if request.quick else None]):
            done = row / len(WAYS) + index / len(WAYS) / len(ORDINATES)
            request.report(f"{way}, {count} ordinates", done)
            image = drawn(request, scene, {"ordinates": count, **settings})
            stops = exposure_of(scene, image.radiance) if not rows else stops
            found = scores(image, truth)
            told[str(count)] = dict(found)
            if row == 0:
                told[str(count)]["frame_ms"] = _moving_ms(request, scene, count)
            pictures.append((f"{count}{off(found)}", image.radiance))
        rows.append((way, exposed(request, pictures, stops)))
        numbers[way] = told
    if truth is not None:
        rows.append(("truth", exposed(request, [("Monte Carlo", truth.radiance)], stops)))
    return Drawn(sheet(request, "More and more ordinates", rows), numbers)


def _moving_ms(request: Request, scene: Scene, ordinates: int) -> float:
    """The median of frames under a turning map; were it still, nothing would be solved."""
    quick = QUICK_POP if request.quick else {}
    with renderer(request, scene, {"ordinates": ordinates, **quick}, technique="pop") as made:
        for turn in range(1 + (1 if request.quick else TIMED_FRAMES)):
            made.scene = turned(scene, float(turn))
            made.frame(read=False)
        return statistics.median(made.frame_ms[1:])
