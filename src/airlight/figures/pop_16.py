"""An expanding plume from frame to frame (Elek2014 Fig. 16)."""

from __future__ import annotations

import dataclasses
from functools import lru_cache
from typing import Any

import numpy as np

from ..maths.colour import luminance
from ..scene.builtin import smoke
from ..scene.checks import F32, F64
from ..scene.scene import Scene
from .panels import Drawn, Request, exposed, exposure_of, renderer, sheet
from .pop_court import courtyard
from .pop_scenes import QUICK_POP

SHOWN_S = (0.0, 0.5, 1.0, 1.5)
STEP_S, STEPS = 0.04, 6


@lru_cache(maxsize=4)
def puff(time_s: float) -> Scene:
    """The builtin smoke alone under the courtyard, at a time."""
    scene = smoke(time=time_s)
    made = dataclasses.replace(scene.volumes[0], g=(0.85,) * 3)
    return dataclasses.replace(
        scene, volumes=(made,), meshes=(), lights=(), environment=courtyard()
    )


def draw(request: Request) -> Drawn:
    """Frames half a second apart, and how unsteady the light is between frames 40 ms apart."""
    # Frames far apart to be looked at, then close ones to be measured, on one renderer.
    images: list[tuple[str, F32]] = []
    quick = QUICK_POP if request.quick else {}
    with renderer(request, puff(0.0), quick, technique="pop") as made:
        for time_s in SHOWN_S[: 1 if request.quick else None]:
            images.append((f"{time_s} s", _frame(made, puff(time_s))))
        series = [
            luminance(_frame(made, puff(STEP_S * k))) for k in range(3 if request.quick else STEPS)
        ]
        spent = made.frame_ms[1:]

    # All are exposed as the first frame is.
    stops = exposure_of(puff(0.0), images[0][1])
    numbers = {"frame_ms": float(np.median(spent)), "step_s": STEP_S, **steadiness(series)}
    row = [("plume", exposed(images, stops))]
    return Drawn(sheet(request, "A plume in motion", row), numbers)


def _frame(made: Any, scene: Scene) -> F32:
    made.scene = scene
    image = made.frame()
    assert image is not None
    return np.asarray(image.radiance)


def steadiness(series: list[F64]) -> dict[str, float]:
    """Of images at equal times: mean change from one to the next, and jerk, what is not even.

    Both relative to the mean light. Jerk is the second difference: 0 for light that changes evenly.
    """
    # First and second differences in time, over the mean light.
    stack = np.stack(series).astype(np.float64)
    mean = max(float(stack.mean()), 1e-30)
    return {
        "change": float(np.abs(np.diff(stack, axis=0)).mean()) / mean,
        "jerk": float(np.abs(np.diff(stack, n=2, axis=0)).mean()) / mean,
        "mean_light_jerk": float(np.abs(np.diff(stack.mean(axis=(1, 2)), n=2)).max()) / mean,
    }
