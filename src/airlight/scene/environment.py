"""Light from infinitely far away, all around the scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from . import checks
from .checks import F32, Rgb


@dataclass(frozen=True, eq=False)
class Environment:
    """A latitude-longitude map or a constant, radiance in W m^-2 sr^-1.

    `map` is (H, W, 3) float32, linear; a direction (x, y, z) towards the environment has
    u = atan2(x, -z)/2pi (mod 1) and v = acos(y)/pi from the top row, as in Mitsuba.
    `rotation_deg` turns the map about +Y, counter-clockwise seen from above.
    `visible = False` keeps the light but not the image.
    """

    radiance: Rgb = (1.0, 1.0, 1.0)
    map: F32 | None = None
    scale: float = 1.0
    rotation_deg: float = 0.0
    visible: bool = True
    source: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "radiance", checks.rgb(self.radiance, "environment radiance"))
        put(self, "scale", checks.number(self.scale, "environment scale", low=0.0))
        put(self, "rotation_deg", checks.number(self.rotation_deg, "environment rotation_deg"))
        put(self, "visible", checks.boolean(self.visible, "environment visible"))
        if self.map is not None:
            pixels = checks.array(
                self.map, "environment map", shape=(None, None, 3), dtype=np.float32
            )
            if pixels.size == 0:
                raise SceneError("environment map has no pixels")
            checks.at_most(pixels, checks.MOST, "environment map")
            if pixels.min() < 0.0:
                pixels = np.maximum(pixels, 0.0)
            put(self, "map", pixels)
