"""Where light on a lattice fails (Billeter2012 Fig. 6): bleeding, blocks, too few iterations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..app.compare.images import shown
from ..scene.builtin import bleeding, one_iteration, pinpoint
from ..scene.scene import Scene
from .clpv_6 import scores
from .panels import Drawn, Request, exposure_of, mean_light, rendered, sheet
from .truths import noise_l2, told_of, truth_of, without_noise

PAPER: Mapping[str, Any] = {
    "scheme": "paper",
    "acceleration": "none",
    "blockers": "maps",
    "single": "random",
    "follow_walls": False,
    "ambient_occlusion": False,
}
"""The paper's hops, its blockers from maps, its points of first-scattered light, its cells along
the world's axes, and no screen-space occlusion."""
PAPER_ITERATIONS = 8
RESOLUTION = 32
CASES: dict[str, tuple[Callable[[], Scene], float]] = {
    "a  board aslant, lit behind": (bleeding, 0.0),
    "b  spot smaller than a cell, +1 stop": (pinpoint, 1.0),
    "c  one iteration, +2 stops": (one_iteration, 2.0),
}
"""What fails, and the stops beyond the truth's exposure at which it shows."""


def draw(request: Request) -> Drawn:
    """Each scene by the paper's scheme, by ours alone and gathered, beside the truth; numbers."""
    rows: list[Any] = []
    numbers: dict[str, Any] = {}
    for label, (make, more) in CASES.items():
        request.report(label, len(numbers) / len(CASES))
        scene = make()
        rows.append((label, _row(request, scene, more, numbers.setdefault(label, {}))))
    return Drawn(sheet(request, "Where a lattice fails", rows), numbers)


def _row(request: Request, scene: Scene, more_stops: float, told: dict[str, Any]) -> list[Any]:
    # The paper's settings, ours, ours iterated where a scene asks for one iteration, ours gathered.
    truth = truth_of(request, scene)
    kept: dict[str, Any] = {} if request.quick else {"resolution": RESOLUTION}
    once = scene.settings.get("lpv-scatter", {})
    paper = {**kept, **PAPER} | ({} if once else {"iterations": PAPER_ITERATIONS})
    modes = {"the paper's": paper, "ours": kept}
    if once:
        modes["ours, iterated"] = {**kept, "iterations": 24, "acceleration": "regions"}
    modes["ours, gathered"] = {**modes[list(modes)[-1]], "gather": "still"}
    images = {
        name: rendered(request, scene, mode, technique="lpv-scatter")
        for name, mode in modes.items()
    }
    # Light that has hardly moved leaves most of an image black: the best one sets the exposure.
    best = list(images.values())[-1] if truth is None else truth.image
    stops = exposure_of(scene, best.radiance) + more_stops
    cells: list[Any] = []
    for name, image in images.items():
        cells.append((name, shown(image.radiance, stops)))
        told[name] = {"mean_indirect": mean_light(image.layers["indirect"])}
        if truth is not None and truth.has_layers:
            found = scores(image.layers["indirect"], truth.image.layers["indirect"])
            # Sparks over all but dark pixels leave no relative error to speak of.
            told[name] |= {key: found[key] for key in ("relative_l2", "energy_ratio")}
    if truth is not None:
        told["path traced"] = {"spp": truth.spp, "notes": list(truth.notes)}
        if truth.has_layers:
            told["path traced"]["noise_floor_l2"] = noise_l2(truth, "indirect")
        light = without_noise(truth, images["ours"])
        cells.append((told_of(truth), shown(light, stops)))
    return cells
