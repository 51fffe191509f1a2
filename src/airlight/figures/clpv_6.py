"""One bounce of the sun in grey stone beside two other methods (Kaplanyan2010 Fig. 6)."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from ..app.compare.images import shown, signed_map
from ..app.compare.reference import Reference
from ..maths.arrays import U8
from ..reference.metrics import noise_floor, relmse, scene_epsilon
from ..scene.builtin import atrium, cornell
from ..scene.checks import F32
from ..scene.image import Image
from .imperfect import LIGHTS, indirect_of
from .panels import Drawn, Request, away, exposure_of, in_clay, mean_light, rendered, sheet
from .truths import averaged, noise_l2, smoothed, told_of, traced

SCHEMES = {"ours": "centroid", "the paper's scheme": "paper"}
IMPERFECT = "imperfect shadow maps"
Row = tuple[str, list[tuple[str, U8 | None]]]


def draw(request: Request) -> Drawn:
    """Whole images, indirect light alone, and where it is too bright (green) or dark (red)."""
    scene = cornell() if request.quick else in_clay(dataclasses.replace(atrium(), environment=None))

    # One bounce by path tracing, for which the image is exposed.
    request.report("path tracing one bounce", 0.0)
    truth = traced(request, scene)
    bounced = truth.image.layers["one_bounce"]
    whole = truth.image.layers["direct"] + bounced
    stops = exposure_of(scene, whole)
    rows: list[Row] = []
    numbers: dict[str, Any] = {"scene": scene.name, "reference": _about(truth), "schemes": {}}

    # Both schemes with one bounce, and their errors.
    for label, scheme in SCHEMES.items():
        request.report(label, 0.5)
        image = rendered(request, scene, {"scheme": scheme, "bounces": False})
        told = scores(image.layers["indirect"], bounced)
        numbers["schemes"][label] = told
        if not rows:
            smooth = smoothed(bounced, image)
            rows.append(_traced(truth, smooth, stops))

        # The paper's intensities are in other units: it is judged by its shapes.
        scale = 1.0 if scheme != "paper" else 1.0 / max(told["energy_ratio"], 1e-30)
        rows.append(_row(label, image, scale, smooth, stops))
        direct = averaged(image.layers["direct"], bounced)

    # The same bounce by imperfect shadow maps, beside the same direct light.
    request.report("imperfect shadow maps", 0.8)
    height, width = bounced.shape[:2]
    indirect = indirect_of(dataclasses.replace(request, size=(width, height)), scene)
    numbers["schemes"][IMPERFECT] = scores(indirect, bounced) | {"virtual_lights": LIGHTS}
    other = Image(direct + indirect, {"direct": direct, "indirect": indirect})
    rows.append(_row(f"{LIGHTS} {IMPERFECT}", other, 1.0, smooth, stops))
    return Drawn(sheet(request, "One bounce, beside other methods", rows), numbers)


def _traced(truth: Reference, smooth: F32, stops: float) -> Row:
    whole = truth.image.layers["direct"] + smooth
    return told_of(truth), [
        ("one bounce", shown(whole, stops)),
        ("indirect alone", shown(smooth, stops)),
    ]


def _row(label: str, image: Image, scale: float, smooth: F32, stops: float) -> Row:
    """`scale`: of the indirect light, so that a scheme of other units is judged by its shapes."""
    indirect = np.float32(scale) * image.layers["indirect"]
    name = label if scale == 1.0 else f"{label} x {scale:.2f}"
    return name, [
        ("one bounce", shown(image.layers["direct"] + indirect, stops)),
        ("indirect alone", shown(indirect, stops)),
        ("too bright green, too dark red", signed_map(averaged(indirect, smooth), smooth, stops)),
    ]


def scores(indirect: F32, truth: F32) -> dict[str, float]:
    """Errors of the light, and its energy over the truth's, at the truth's size."""
    indirect = averaged(indirect, truth)
    return {
        "relative_l2": away(indirect, truth),
        "relmse": relmse(indirect, truth, scene_epsilon(truth)),
        "energy_ratio": mean_light(indirect) / max(mean_light(truth), 1e-30),
    }


def _about(truth: Reference) -> dict[str, Any]:
    layers, bounced = truth.image.layers, truth.image.layers["one_bounce"]
    floor = noise_floor(layers["one_bounce_variance"], bounced, scene_epsilon(bounced))
    return {
        "renderer": "mitsuba",
        "spp": truth.spp,
        "seconds": truth.seconds,
        "noise_floor_relmse": floor,
        "noise_floor_l2": noise_l2(truth, "one_bounce"),
        "notes": list(truth.notes),
    }
