"""What the tests of shafts share: a box of air, a sheet that shades half of it, and a measure."""

from __future__ import annotations

import numpy as np

from airlight.scene import DirectionalLight, PointLight, SpotLight

BOX = ((-2.0, -1.5, -2.0), (2.0, 2.0, 2.0))
RGB = (3.0, 2.0, 1.0)
TRAVEL = tuple(np.array([0.35, -0.8, -0.3]) / np.linalg.norm([0.35, -0.8, -0.3]))
SHEET_Y = 0.5  # height of a dark sheet that fills the half plane x < 0


def is_lit(light: DirectionalLight | PointLight | SpotLight, p: np.ndarray) -> np.ndarray:
    """Whether the sheet leaves points (..., 3) in the light; a directional one goes TRAVEL."""
    towards = -np.array(TRAVEL) if isinstance(light, DirectionalLight) else light.position - p
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (SHEET_Y - p[..., 1]) / towards[..., 1]
    x = p[..., 0] + s * towards[..., 0]
    reach = np.inf if isinstance(light, DirectionalLight) else 1.0
    return np.asarray(~((s > 0.0) & (s < reach) & (x < 0.0)))


def compressed_l2(a: np.ndarray, b: np.ndarray) -> float:
    """Relative L2 error of what is seen: the peak at a lamp, a pixel wide, is compressed."""
    a, b = a / (a + b.mean()), b / (b + b.mean())
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))
