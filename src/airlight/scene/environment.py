"""Light from infinitely far away, all around the scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from . import checks
from .checks import F32, Rgb
from .sun_sky import Sky


@dataclass(frozen=True, eq=False)
class Environment:
    """A latitude-longitude map or a constant, radiance in W m^-2 sr^-1.

    `map` is (H, W, 3) float32, linear; a direction (x, y, z) towards the environment has
    u = atan2(x, -z)/2pi (mod 1) and v = acos(y)/pi from the top row, as in Mitsuba.
    `scale` multiplies map or constant; `source` is the file that the map came from, if any.
    `rotation_deg` turns the map about +Y, counter-clockwise seen from above.
    `visible = False` keeps the light but not the image. `horizon`: the map's upper and lower half
    do not blend where they meet. `sky`: what made the map; its sun is a light of the scene, and
    only seen here.
    """

    radiance: Rgb = (1.0, 1.0, 1.0)
    map: F32 | None = None
    scale: float = 1.0
    rotation_deg: float = 0.0
    visible: bool = True
    source: str = ""
    horizon: bool = False
    sky: Sky | None = None

    @classmethod
    def of_sky(cls, sky: Sky) -> Environment:
        """A clear sky over its ground; its light (`sky.sun()`) is to be among the scene's."""
        return cls(map=sky.map(), source="sky", horizon=True, sky=sky)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "radiance", checks.rgb(self.radiance, "environment radiance"))
        put(self, "scale", checks.number(self.scale, "environment scale", low=0.0))
        put(self, "rotation_deg", checks.number(self.rotation_deg, "environment rotation_deg"))
        put(self, "visible", checks.boolean(self.visible, "environment visible"))
        put(self, "horizon", checks.boolean(self.horizon, "environment horizon"))
        if self.map is not None:
            pixels = checks.array(
                self.map, "environment map", shape=(None, None, 3), dtype=np.float32
            )
            if pixels.size == 0:
                raise SceneError("environment map has no pixels")
            checks.at_most(pixels, checks.MOST, "environment map")
            # Negative radiance, as ringing filters leave it, is none.
            if pixels.min() < 0.0:
                pixels = np.maximum(pixels, 0.0)
            put(self, "map", pixels)

    def rows_apart(self, factor: int) -> F32:
        """The map with `factor` times as many rows, for who knows no horizon.

        Its halves stay apart but for one of those rows; elsewhere it is read as before.
        """
        assert self.map is not None
        # Rows of sky and ground are resampled apart: each clamps at the horizon instead of reading
        # the other half.
        height = self.map.shape[0]
        if not self.horizon or height < 2:
            return self.map
        # Rows of the finer map in rows of the old one; each half ends at its own last row.
        middle = (height + 1) // 2
        at = (np.arange(height * factor) + 0.5) / factor - 0.5
        is_up = np.arange(len(at)) < middle * factor
        row = np.clip(at, np.where(is_up, 0, middle), np.where(is_up, middle - 1, height - 1))
        first = np.minimum(row.astype(np.int64), height - 2)
        share = (row - first)[:, None, None].astype(np.float32)
        return np.asarray(self.map[first] * (1.0 - share) + self.map[first + 1] * share)
