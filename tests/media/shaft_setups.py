"""What the tests of shafts share: a box of air, a sheet that shades half of it, and a measure."""

from __future__ import annotations

from typing import Any

import numpy as np

from airlight.reference.quadrature import box_path, spot_falloff
from airlight.scene import DirectionalLight, PointLight, SpotLight

Light = DirectionalLight | PointLight | SpotLight

BOX = ((-2.0, -1.5, -2.0), (2.0, 2.0, 2.0))
RGB = (3.0, 2.0, 1.0)
TRAVEL = tuple(np.array([0.35, -0.8, -0.3]) / np.linalg.norm([0.35, -0.8, -0.3]))
SHEET_Y = 0.5  # height of a dark sheet that fills the half plane x < 0


def is_lit(light: Light, p: np.ndarray) -> np.ndarray:
    """Whether the sheet leaves points (..., 3) in the light; a directional one goes TRAVEL."""
    towards = -np.array(TRAVEL) if isinstance(light, DirectionalLight) else light.position - p
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (SHEET_Y - p[..., 1]) / towards[..., 1]
    x = p[..., 0] + s * towards[..., 0]
    reach = np.inf if isinstance(light, DirectionalLight) else 1.0
    return np.asarray(~((s > 0.0) & (s < reach) & (x < 0.0)))


Arriving = tuple[np.ndarray, np.ndarray | float, np.ndarray, np.ndarray, tuple[float, ...]]


def unshaded(light: Light, p: np.ndarray, box: Any = BOX) -> Arriving:
    """Of points (..., 3) in a `box`: how a light's rays travel there, from how far, and so on.

    (travel (..., 3), distance m, gain of its colour, path in the box m, colour).
    """
    if isinstance(light, DirectionalLight):
        travel, r, gain = np.broadcast_to(np.array(TRAVEL), p.shape), np.inf, np.ones(p.shape[:-1])
        return travel, r, gain, box_path(p, -np.array(TRAVEL), box)[1], light.irradiance
    away = p - np.array(light.position)
    r = np.linalg.norm(away, axis=-1)
    travel, gain = away / r[..., None], 1.0 / r**2
    if isinstance(light, SpotLight):
        cosine = travel @ np.array(light.direction)
        gain = gain * spot_falloff(cosine, light.inner_deg, light.outer_deg)
    return travel, r, gain, np.minimum(r, box_path(p, -travel, box)[1]), light.intensity


def compressed_l2(a: np.ndarray, b: np.ndarray) -> float:
    """Relative L2 error of what is seen: the peak at a lamp, a pixel wide, is compressed."""
    a, b = a / (a + b.mean()), b / (b + b.mean())
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))
