"""Light that leaked: indirect light on surfaces that a reference says are dark."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..app.compare.images import shown
from ..maths.arrays import U8
from ..maths.colour import luminance, srgb_encode
from ..reference.metrics_display import displayed
from ..scene.builtin import cornell, room
from ..scene.checks import F32, F64
from ..scene.scene import Scene
from .panels import Drawn, Request, exposure_of, from_here, rendered, sheet
from .truths import averaged, smoothed, told_of, traced

DARK_SHARE = 0.15
"""Of the reference's mean indirect luminance: what has less is dark."""
EXCESS = 2.0
"""Light counts as leaked where it is more than this many times the reference's."""
MODES: Mapping[str, Mapping[str, Any]] = {"paper's scheme": {"scheme": "paper"}, "ours": {}}


def draw(request: Request) -> Drawn:
    """The room's shelf, boards of 22 mm: each scheme's indirect light, and what of it leaked."""
    scene = cornell() if request.quick else shelf()

    # The truth's indirect light says which surfaces are dark.
    truth = traced(request, scene)
    light = truth.image.layers["indirect"]
    stops = exposure_of(scene, light)
    numbers: dict[str, Any] = {"dark_share_of_surfaces": float(dark_places(light).mean())}
    rows: list[tuple[str, list[tuple[str, U8 | None]]]] = []
    for label, settings in MODES.items():
        # Each scheme at the truth's size, and its light beyond the truth's.
        image = rendered(request, scene, settings)
        if not rows:
            smooth = smoothed(light, image)
            rows.append((told_of(truth), [("indirect light", shown(smooth, stops))]))
        indirect = image.layers["indirect"]
        coarse = averaged(indirect, light)
        share = leaked_share(coarse, light)
        numbers[label] = {"leaked_over_all_indirect": share}
        leak = leak_image(coarse, light, stops)
        rows.append(
            (label, [("indirect light", shown(indirect, stops)), (f"leaked: {share:.1%}", leak)])
        )
    return Drawn(sheet(request, "Light that leaked", rows), numbers)


def shelf() -> Scene:
    """`builtin:room` before its shelf."""
    return from_here(room(), (-0.2, 1.3, -0.6), (2.4, 1.0, -1.3))


def dark_places(truth: F32) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """(H, W): where the reference's indirect light is dark, but something is there."""
    light = luminance(truth)
    return np.asarray((light > 0.0) & (light < DARK_SHARE * light.mean()))


def leaked(indirect: F32, truth: F32) -> F64:
    """(H, W) luminance, W m^-2 sr^-1, beyond the reference's on places that it has dark."""
    light, true = luminance(indirect), luminance(truth)
    has_leaked = dark_places(truth) & (light > EXCESS * true)
    return np.where(has_leaked, light - true, 0.0)


def leaked_share(indirect: F32, truth: F32) -> float:
    """The leaked light over all of the reference's indirect light."""
    return float(leaked(indirect, truth).sum() / max(luminance(truth).sum(), 1e-30))


def leak_image(indirect: F32, truth: F32, stops: float) -> U8:
    """The reference toned down to grey, what leaked in red over it; (H, W, 3)."""
    grey = 0.25 * luminance(displayed(truth, stops))
    leak = leaked(indirect, truth)
    red = luminance(displayed(np.repeat(leak[..., None], 3, -1).astype(np.float32), stops))
    linear = np.stack([np.maximum(grey, red), grey * (leak <= 0.0), grey * (leak <= 0.0)], -1)
    return np.rint(255.0 * srgb_encode(np.clip(linear, 0.0, 1.0))).astype(np.uint8)
