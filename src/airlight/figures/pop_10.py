"""A lamp in a ball of air beside Monte Carlo (Elek2014 Fig. 10)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..app.compare.images import contact_sheet, shown
from ..maths.arrays import U8
from ..scene.camera import Camera
from ..scene.checks import F32, F64
from ..scene.image import Image
from ..scene.lights import PointLight
from ..scene.scene import Scene
from ..scene.volume import Volume
from .panels import Drawn, Request, exposure_of
from .pop_ball import RINGS, leaving
from .pop_scenes import drawn, errors

RADIUS_M = 2.5
SIGMA_S = (0.8, 1.0, 1.3)
ANISOTROPIES = (0.0, 0.5, 0.9)
SCHEMES = {"delta-beam": "delta-beam", "split": "split, a radial grid"}
_VIEW_M = 60.0  # so far away that rays are parallel, nearly


def ball(g: float) -> Scene:
    """The ball alone, a lamp of 1 W/sr at its middle, seen from far away."""
    box = ((-RADIUS_M,) * 3, (RADIUS_M,) * 3)
    made = Volume(SIGMA_S, shape="sphere", bounds=box, g=(g,) * 3, source="ball")
    angle = 2.0 * np.degrees(np.arctan(1.05 * RADIUS_M / _VIEW_M))
    camera = Camera((0.0, 0.0, _VIEW_M), (0.0, 0.0, 0.0), fov_y_deg=float(angle))
    light = PointLight((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    return Scene(name="ball", camera=camera, lights=(light,), volumes=(made,))


def draw(request: Request) -> Drawn:
    """Images and what leaves the ball towards the eye, W/sr; the 32^3 grids of the paper."""
    # Square images; a row for each phase function.
    small = Request((request.size[1], request.size[1]), request.quick, request.adapter)
    rows: list[Any] = []
    numbers: dict[str, Any] = {"radius_m": RADIUS_M, "sigma_s": SIGMA_S}
    for index, g in enumerate(ANISOTROPIES[: 1 if request.quick else 3]):
        request.report(f"g = {g}", index / len(ANISOTROPIES))
        scene, cells = ball(g), []
        told: dict[str, Any] = {}

        # The truth uses the ball's symmetry, so few photons make it.
        truth = by_monte_carlo(scene, small.size[0], g, 2_000 if request.quick else 1_000_000)
        stops = exposure_of(scene, truth.radiance)
        for scheme, name in SCHEMES.items():
            settings = {"scheme": scheme, "grid": 32, "iterations": 55, "march": "full"}

            # Each scheme's scattered light, and the power that leaves towards the eye.
            light = drawn(small, scene, settings).layers["scattered"]
            told[scheme] = errors(light, truth)
            told[scheme]["intensity_over_monte_carlo"] = (
                seen(scene, light) / seen(scene, truth.radiance)
            ).tolist()
            caption = f"{name}: off by {told[scheme]['relative_l2']:.2f}"
            cells.append((caption, shown(light, stops)))
        cells.append(("Monte Carlo", shown(truth.radiance, stops)))
        numbers[f"g {g}"] = told
        rows.append((f"g = {g}", cells))
    sheet: U8 = contact_sheet("A lamp in a ball", rows, cell_width_px=max(request.size[1], 240))
    return Drawn(sheet, numbers)


def seen(scene: Scene, light: F32) -> F64:
    """Intensity (3,), W/sr, of a square image from far away: radiance times its pixels' area."""
    # The square that the image shows at the ball's distance.
    side = 2.0 * _VIEW_M * np.tan(0.5 * np.radians(scene.camera.fov_y_deg))
    return np.asarray(light.mean(axis=(0, 1), dtype=np.float64) * side**2)


def by_monte_carlo(scene: Scene, side_px: int, g: float, photons: int) -> Image:
    """The square image of the ball, and its variance."""
    # How far from the ball's middle each pixel's ray passes.
    at = 2.0 * (np.arange(side_px) + 0.5) / side_px - 1.0
    away = np.hypot(at[:, None], at[None, :]) * np.tan(0.5 * np.radians(scene.camera.fov_y_deg))
    impact_m = _VIEW_M * away / np.sqrt(1.0 + away**2)

    # A profile for each channel, read at those distances.
    profiles = [leaving(RADIUS_M, sigma, g, photons) for sigma in SIGMA_S]
    radiance = np.stack([p.at(impact_m) for p in profiles], axis=-1)
    inside = impact_m < RADIUS_M

    # The variance is that of the ring that a pixel lies in.
    index = np.where(inside, impact_m / RADIUS_M * RINGS, 0.0).astype(int)
    variance = np.stack([np.where(inside, p.error[index] ** 2, 0.0) for p in profiles], axis=-1)
    return Image(radiance.astype(np.float32), {"variance": variance.astype(np.float32)})
