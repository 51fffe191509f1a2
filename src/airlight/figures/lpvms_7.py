"""Foggy scenes beside a path tracer's (Billeter2012 Fig. 7 and 8), with scores."""

from __future__ import annotations

from typing import Any

from ..app.compare.images import shown, signed_map
from ..maths.arrays import U8
from ..reference.metrics import Metrics, compare
from ..scene.builtin import atrium_fog, foggy_room, haze_box
from ..scene.scene import Scene
from .panels import Drawn, Request, exposure_of, rendered, sheet
from .truths import as_large_as, told_of, traced, without_noise

SCORES = ("relmse", "relative_l2", "noise_floor_l2", "flip", "hdr_flip", "energy_ratio")
LAYERS = ("direct", "indirect", "single_scatter", "multiple_scatter")
Cells = list[tuple[str, U8 | None]]


def draw(request: Request) -> Drawn:
    """A row per scene: path traced, ours, and where ours is too bright or too dark."""
    scenes = (haze_box(),) if request.quick else (atrium_fog(), foggy_room(), haze_box())
    rows, numbers = [], {}
    for index, scene in enumerate(scenes):
        request.report(scene.name, index / len(scenes))
        cells, numbers[scene.name] = _beside(request, scene)
        rows.append((scene.name, cells))
    return Drawn(sheet(request, "Fog, beside a path tracer", rows), numbers)


def _beside(request: Request, scene: Scene) -> tuple[Cells, dict[str, Any]]:
    # The truth first: it sets size and exposure.
    truth = traced(request, scene)
    image = rendered(request, scene, technique="lpv-scatter")
    small = as_large_as(image, truth.image.radiance)
    found = compare(small, truth.image)
    stops = exposure_of(scene, truth.image.radiance)
    # Grain would be all that a map of signs shows.
    light = without_noise(truth, image)
    cells: Cells = [
        (told_of(truth), shown(light, stops)),
        ("ours", shown(image.radiance, stops)),
        ("too bright green, too dark red", signed_map(small.radiance, light, stops)),
    ]
    told: dict[str, Any] = {"spp": truth.spp, "seconds": truth.seconds, **_scores(found)}
    told["notes"] = list(truth.notes)
    told["layers"] = {n: _scores(found.layers[n]) for n in LAYERS if n in found.layers}
    return cells, told


def _scores(found: Metrics) -> dict[str, float | None]:
    return {name: found[name] for name in SCORES}
