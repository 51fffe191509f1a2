"""One bounce in the atrium of grey stone beside a path tracer's (Kaplanyan2010 Fig. 6)."""

from __future__ import annotations

from typing import Any

from ..app.compare_pictures import U8, shown, signed_map
from ..app.compare_reference import Reference, reference_for
from ..reference.metrics import noise_floor, relmse, scene_epsilon
from ..scene.builtin import atrium, cornell
from ..scene.checks import F32
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Drawn, Request, exposure_of, in_clay, mean_light, rendered, sheet

SCHEMES = {"ours": "centroid", "the paper's scheme": "paper"}
Row = tuple[str, list[tuple[str, U8 | None]]]


def draw(request: Request) -> Drawn:
    """Whole pictures, indirect light alone, and where it is too bright (green) or dark (red)."""
    scene = cornell() if request.quick else in_clay(atrium())
    request.report("path tracing one bounce", 0.0)
    truth = reference_for(scene, request.size, request.reference_spp, report=request.report)
    bounced = truth.image.layers["one_bounce"]
    whole = truth.image.layers["direct"] + bounced
    stops = exposure_of(scene, whole)
    traced: list[tuple[str, U8 | None]] = [
        ("one bounce", shown(whole, stops)), ("indirect alone", shown(bounced, stops)),
    ]  # fmt: skip
    rows: list[Row] = [("path traced", traced)]
    numbers: dict[str, Any] = {"scene": scene.name, "reference": _about(truth), "schemes": {}}
    for label, scheme in SCHEMES.items():
        request.report(label, 0.5)
        image = rendered(request, scene, {"scheme": scheme, "bounces": False})
        rows.append(_row(label, image, bounced, stops))
        numbers["schemes"][label] = scores(image.layers["indirect"], bounced)
    return Drawn(sheet(request, "One bounce, beside a path tracer", rows), numbers)


def _row(label: str, image: Image, bounced: F32, stops: float) -> Row:
    indirect = image.layers["indirect"]
    return label, [
        ("one bounce", shown(image.layers["direct"] + indirect, stops)),
        ("indirect alone", shown(indirect, stops)),
        ("too bright green, too dark red", signed_map(indirect, bounced, stops)),
    ]


def scores(indirect: F32, truth: F32) -> dict[str, float]:
    """relmse of the light and its energy over the truth's."""
    return {
        "relmse": relmse(indirect, truth, scene_epsilon(truth)),
        "energy_ratio": mean_light(indirect) / max(mean_light(truth), 1e-30),
    }


def _about(truth: Reference) -> dict[str, Any]:
    layers, bounced = truth.image.layers, truth.image.layers["one_bounce"]
    floor = noise_floor(layers["one_bounce_variance"], bounced, scene_epsilon(bounced))
    return {
        "renderer": "mitsuba", "spp": truth.spp, "seconds": truth.seconds,
        "noise_floor_relmse": floor, "notes": list(truth.notes),
    }  # fmt: skip


def truth_of(request: Request, scene: Scene) -> Reference | None:
    """All bounces by path tracing; None with --quick."""
    if request.quick:
        return None
    return reference_for(scene, request.size, request.reference_spp, report=request.report)
