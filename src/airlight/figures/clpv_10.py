"""Indirect light of foliage while the sun moves, and how far it jumps (Kaplanyan2010 Fig. 10)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..app.bench.frames import TURN_DEG, moved
from ..app.compare.images import heat, shown
from ..maths.arrays import U8
from ..maths.colour import luminance
from ..scene.builtin import atrium
from ..scene.checks import F32
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Drawn, Request, exposure_of, from_here, renderer, sheet

Row = tuple[str, list[tuple[str, U8 | None]]]

STEPS = 5  # images, the sun turned a quarter of a degree between them
FULL_CHANGE = 0.05  # relative change that gets the brightest colour


def draw(request: Request) -> Drawn:
    """One bounce without occlusion, as the paper's; ours; and how much moves beyond the sun."""
    # The paper's settings and ours, under the same moving directional light.
    scene = from_here(atrium(), (-1.6, 1.55, 0.5), (1.5, 1.0, 2.6))
    modes: dict[str, dict[str, bool]] = {
        "one bounce, no occlusion": {"occlusion": False, "bounces": False},
        "ours": {},
    }
    rows: list[Row] = []
    numbers: dict[str, Any] = {"scene": "atrium", "steps": STEPS, "turn_deg": TURN_DEG}
    modes_told: dict[str, Any] = {}
    for label, settings in modes.items():
        request.report(label, len(rows) / len(modes))
        images = turning(request, scene, settings)

        # Light of every step at each pixel, and how far it is off a straight line in time.
        light = np.stack([luminance(image.layers["indirect"]) for image in images])
        jumps = flicker(light)

        # Panels of the first step; flicker on a scale of its own.
        stops = exposure_of(scene, images[0].radiance)
        change = (jumps / FULL_CHANGE).astype(np.float32)
        cells: list[tuple[str, U8 | None]] = [
            ("all light", shown(images[0].radiance, stops)),
            ("indirect light", shown(images[0].layers["indirect"], stops)),
            (f"flicker, white at {FULL_CHANGE:.0%}", heat(change)),
        ]
        rows.append((label, cells))
        modes_told[label] = _told(light, jumps)
    numbers["modes"] = modes_told
    return Drawn(sheet(request, "Foliage under a moving sun", rows), numbers)


def _told(light: Any, jumps: F32) -> dict[str, float]:
    # Change from step to step, over the mean light; the flicker is the part that jumps.
    change = np.abs(np.diff(light, axis=0)).mean() / max(light.mean(), 1e-30)
    return {
        "mean_indirect": float(light.mean()),
        "mean_change_per_step": float(change),
        "mean_flicker": float(jumps.mean()),
        "flicker_99_percent": float(np.percentile(jumps, 99)),
    }


def turning(request: Request, scene: Scene, settings: dict[str, Any]) -> list[Image]:
    """Images while the sun turns; the same pixels see the same surfaces in each."""
    with renderer(request, scene, settings) as made:
        # The directional light alone moves, in steps of one angle.
        images = [made.frame(lights=moved(scene.lights, step)) for step in range(STEPS)]
    return [image for image in images if image is not None]


def flicker(light: Any) -> F32:
    """What changes from image to image beyond a steady drift, over the mean light.

    `light` (steps, H, W); the mean over steps of |L[k-1] - 2 L[k] + L[k+1]| / 2, relative.
    """
    bend = 0.5 * np.abs(light[:-2] - 2.0 * light[1:-1] + light[2:]).mean(axis=0)
    return np.asarray(bend / max(float(light.mean()), 1e-30), dtype=np.float32)
