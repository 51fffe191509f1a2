"""Few ordinates, chosen in different ways (Elek2014 Fig. 7).

The paper chooses its ordinates by what the camera sees of them, too. Ours do so on request, and
move as smoothly as the camera then.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .panels import Drawn, Request, exposed, exposure_of, known, sheet
from .pop_scenes import differences, drawn, off, scores, traced, white_plume

G, ORDINATES, MANY = 0.98, 27, 512
VARIANTS: Mapping[str, Mapping[str, Any]] = {
    "the default": {},
    "by what is seen": {"importance": "view"},
    "parts of the map": {"ordinates_from": "partition", "exact_sky": False},
    "samples of the map": {"ordinates_from": "importance", "exact_sky": False},
    "samples by importance": {
        "ordinates_from": "importance",
        "importance": "view",
        "exact_sky": False,
    },
}


def ways() -> dict[str, dict[str, Any]]:
    """Name -> settings that the technique has."""
    # Ways that settings of the technique make equal are drawn once.
    found: dict[str, dict[str, Any]] = {}
    for name, settings in VARIANTS.items():
        kept = known("pop", settings)
        if kept not in found.values():
            found[name] = kept
    return found


def draw(request: Request) -> Drawn:
    """27 ordinates for a medium of g = 0.98, chosen in five ways, and how far each is from 512."""
    # Smoke of a sharp phase function, where few ordinates show.
    scene = white_plume(G)
    truth = traced(request, scene)
    shown, told, images = [], {}, {}

    # Each way's image and its errors.
    for name, settings in ways().items():
        images[name] = image = drawn(request, scene, {"ordinates": ORDINATES, **settings})
        told[name] = scores(image, truth)
        shown.append((f"{name}{off(told[name])}", image.radiance))

    # Many ordinates are what all of the ways tend to.
    best = drawn(request, scene, {"ordinates": MANY})
    shown.append((f"{MANY} ordinates", best.radiance))
    stops = exposure_of(scene, shown[0][1])
    if truth is not None:
        shown.append(("Monte Carlo", truth.radiance))

    # Images, how far each is from many ordinates, and the truths.
    few = len(images)
    rows = [
        ("", exposed(shown[:few], stops)),
        (f"beside {MANY}", differences(images, best)),
        ("", exposed(shown[few:], stops)),
    ]
    numbers = {"g": G, "ordinates": ORDINATES, "ways": told}
    return Drawn(sheet(request, f"Few ordinates: {ORDINATES}", rows), numbers)
