"""Light that bleeds through thin things, and a shadow that is lost (Kaplanyan2010 Fig. 11).

The paper's scheme takes blockers from what camera and lights see, and loses the shadow of what
they do not; by default blockers come from samples of all surfaces.
"""

from __future__ import annotations

from typing import Any

from ..app.compare.images import shown
from ..scene.builtin.patch import lambert
from ..scene.builtin.solids import box, shell
from ..scene.camera import Camera
from ..scene.lights import SpotLight
from ..scene.scene import Scene
from .clpv_6 import scores
from .clpv_11_boxes import boxes_row
from .clpv_leaks import shelf
from .panels import Drawn, Request, exposure_of, mean_light, rendered, sheet
from .truths import smoothed, told_of, truth_of

WALLS_M = (0.02, 0.1, 0.25)
ROOM_M = (6.0, 3.0, 3.0)
_SHELL_M = 0.2


def draw(request: Request) -> Drawn:
    """A shelf of 22 mm boards, a dark room behind a wall of three thicknesses, a hidden box."""
    told: dict[str, Any] = {}
    leaks: dict[str, Any] = {}
    shadows: dict[str, Any] = {}
    rows = [("shelf", _shelf(request, told)), *_walls(request, leaks)]
    rows.append(boxes_row(request, shadows))
    numbers = {"shelf": told, "wall": leaks, "hidden box": shadows}
    return Drawn(sheet(request, "Light through thin things, and a lost shadow", rows), numbers)


def _shelf(request: Request, told: dict[str, Any]) -> list[Any]:
    scene = shelf()
    truth = truth_of(request, scene)
    first = rendered(request, scene)
    stops = exposure_of(scene, first.radiance)

    # Finer cells than the default's show whether a leak is one of resolution.
    fine = {} if request.quick else {"resolution": 64}
    cells = []
    for label, image in (
        ("paper's scheme", rendered(request, scene, {"scheme": "paper"})),
        ("ours", first),
        ("ours, finer", rendered(request, scene, fine)),
    ):
        cells.append((label, shown(image.layers["indirect"], stops)))
        told[label] = {"mean_indirect": mean_light(image.layers["indirect"])}
        if truth is not None:
            told[label] |= scores(image.layers["indirect"], truth.image.layers["indirect"])

    # The path tracer's image is smoothed to be looked at; scores took it as it is.
    if truth is not None:
        smooth = smoothed(truth.image.layers["indirect"], first)
        cells.append((told_of(truth), shown(smooth, stops)))
    return cells


def _walls(request: Request, leaks: dict[str, Any]) -> list[Any]:
    rows: list[Any] = []
    modes: dict[str, dict[str, str]] = {"paper's scheme": {"scheme": "paper"}, "ours": {}}

    # In each mode the light without a wall is what shares count from.
    for label, settings in modes.items():
        open_ = rendered(request, two_rooms(None), settings)
        stops = exposure_of(two_rooms(None), open_.radiance)
        cells = [("no wall", shown(open_.radiance, stops))]
        lit, told = mean_light(open_.layers["indirect"]), {}

        # What comes through a wall of each thickness.
        for wall_m in WALLS_M:
            image = rendered(request, two_rooms(wall_m), settings)
            share = mean_light(image.layers["indirect"]) / max(lit, 1e-30)
            told[f"{wall_m} m"] = share
            cells.append((f"{1e3 * wall_m:.0f} mm: {share:.1%}", shown(image.radiance, stops)))
        leaks[label] = {"share_of_indirect_light_that_leaks": told, "cells": open_.stats["lattice"]}
        rows.append((label, cells))
    return rows


def two_rooms(wall_m: float | None) -> Scene:
    """A closed white box, a lamp in its left half, the eye in its right; a wall between.

    Behind the wall (`wall_m` thick; None: no wall) it is dark.
    """
    # A closed shell, and a wall across its middle.
    x, y, z = ROOM_M[0] / 2.0, ROOM_M[1], ROOM_M[2] / 2.0
    slabs = shell((-x, 0.0, -z), (x, y, z), _SHELL_M)
    if wall_m is not None:
        slabs.append(box((-0.5 * wall_m, 0.0, -z), (0.5 * wall_m, y, z)))

    # All of one white finish, lit on one side alone.
    white = lambert("white", (0.7,) * 3)
    meshes = tuple(mesh for slab in slabs for mesh in white.meshes(slab, "slab"))
    spot = SpotLight((-1.6, 2.8, 0.0), (0.0, -1.0, 0.0), (30.0, 30.0, 30.0), 40.0, 60.0)
    camera = Camera((2.8, 1.6, 1.2), (0.2, 1.4, -0.3), fov_y_deg=60.0, exposure_stops=None)
    return Scene(name="two-rooms", meshes=meshes, lights=(spot,), camera=camera)
