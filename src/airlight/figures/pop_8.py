"""What the isotropic residuum saves at an unchanged image (Elek2014 Fig. 8)."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..app.bench.tables import milliseconds
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import (
    Drawn,
    Request,
    away,
    exposed,
    exposure_of,
    mean_light,
    renderer,
    sheet,
)
from .pop_scenes import drawn, milk, turned

GRID, ORDINATES, FULL, SWITCHED, SHARED = 16, 64, 100, 20, 20
CASES = (("map 1, front", 0.0, (1.5, 2.0, 7.0)), ("map 2, back", 150.0, (-2.0, 1.0, -7.0)))
_PAPER: Mapping[str, Any] = {
    "scheme": "paper",
    "grid": GRID,
    "ordinates": ORDINATES,
    "residuum_iterations": SHARED,
}
SCHEMES: Mapping[str, Mapping[str, Any]] = {
    "all hops": {**_PAPER, "iterations": FULL, "residuum": False},
    "residuum": {**_PAPER, "iterations": SWITCHED, "residuum": True},
    "split": {"scheme": "split", "grid": GRID, "iterations": SWITCHED},
    "delta-beam": {"grid": GRID},
}
_SOLVING = (
    "pop propagation",
    "pop merge",
    "pop residuum",
    "pop paths",
    "pop deposit",
    "pop diffuse",
)
_QUICK: Mapping[str, Any] = {"grid": 6, "ordinates": 4, "iterations": 4}
_TIMED_SIZE_PX = (64, 36)  # what solves does not depend on the image
_ROUNDS = 2


def draw(request: Request) -> Drawn:
    """Milk under two maps: the paper's hops alone, with its residuum, and what replaces both.

    The paper's scheme is too bright by the factor that its captions name, and shown darker.
    """
    rows, numbers = [], {}

    # Each map, timed before its images are drawn.
    for name, angle, position in CASES[: 1 if request.quick else 2]:
        scene = turned(milk(position), angle)
        request.report(f"{name}: timing", 0.0)
        times = timed(request, scene)
        images = {}
        for index, (label, settings) in enumerate(SCHEMES.items()):
            request.report(f"{name}: {label}", index / len(SCHEMES))
            images[label] = drawn(request, scene, settings)
        cells, told = _cells(request, scene, images, times)
        told["speed_up"] = sum(times["all hops"].values()) / sum(times["residuum"].values())
        numbers[name] = told
        rows.append((name, cells))

    # The paper's own numbers, for the same counts of hops.
    numbers["paper"] = {"speed_up": 4.0, "hops": [FULL, SWITCHED, SHARED]}
    return Drawn(sheet(request, "Milk: all hops, and an isotropic residuum", rows), numbers)


def _cells(
    request: Request, scene: Scene, images: dict[str, Image], times: dict[str, dict[str, float]]
) -> tuple[list[Any], dict[str, Any]]:
    # The default scheme's light is what the paper's is measured by.
    cells: list[Any] = []
    told: dict[str, Any] = {}
    usual = mean_light(images["delta-beam"].layers["scattered"])
    full = images["all hops"].layers["scattered"]

    # Each scheme's time, and where it is the paper's, by how much it is too bright.
    for label, image in images.items():
        spent, light = sum(times[label].values()), image.layers["scattered"]
        told[label] = {"ms": times[label], "solving_ms": spent, "hops": image.stats.get("hops")}
        caption, stops = f"{label}: {milliseconds(spent)} ms", exposure_of(scene, image.radiance)
        shown = image.radiance
        if SCHEMES[label].get("scheme") == "paper":
            brighter = mean_light(light) / max(usual, 1e-30)
            told[label] |= {
                "from_all_hops_l2": away(light, full),
                "times_delta_beam_s_light": brighter,
            }
            shown = shown - (1.0 - 1.0 / max(brighter, 1e-30)) * light
            caption += f", its light divided by {brighter:.1f}"
        cells += exposed([(caption, shown.astype(np.float32))], stops)
    return cells, told


def timed(request: Request, scene: Scene) -> dict[str, dict[str, float]]:
    """Milliseconds of the stages that solve, of each scheme: the least of alternated rounds."""
    # Small images: only the solve is timed.
    quick = _QUICK if request.quick else {}
    small = Request(_TIMED_SIZE_PX, request.quick, request.adapter)
    rounds: list[dict[str, dict[str, float]]] = []

    # All renderers stay open, and take their rounds one after the other.
    with contextlib.ExitStack() as opened:
        made = {
            label: opened.enter_context(
                renderer(small, scene, {**settings, **quick}, technique="pop")
            )
            for label, settings in SCHEMES.items()
        }

        # The first frame compiles.
        for one in made.values():
            one.frame(read=False)

        # The map turns in every round, or nothing would be solved again.
        for turn in range(1 if request.quick else _ROUNDS):
            rounds.append({})
            for label, one in made.items():
                one.scene = turned(scene, _angle(scene) + 1.0 + turn)  # else nothing is solved
                passes = one.timed_passes()
                rounds[-1][label] = {n: passes[n] for n in _SOLVING if n in passes}
    return {
        label: min((of[label] for of in rounds), key=lambda found: sum(found.values()))
        for label in SCHEMES
    }


def _angle(scene: Scene) -> float:
    assert scene.environment is not None
    return scene.environment.rotation_deg
