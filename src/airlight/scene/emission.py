"""Light that a volume gives off itself: fire, plasma, glowing gas."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import SceneError
from ..maths.blackbody import rec709_of_grid
from ..maths.colour import in_rgb
from . import checks
from .checks import F32, Rgb

WHITE: Rgb = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Emission:
    """What a volume emits per metre of path, the same in all directions, linear Rec.709.

    Three forms, all W m^-3 sr^-1 in the end:
    `radiance` alone: that much at density 1, and in proportion to the density.
    with `grid`: `radiance` times the grid's value, (z, y, x) or (z, y, x, 3), whatever the density.
    with `temperature`: `radiance`, m^-1, times the radiance of a black body (`maths.blackbody`) of
    (value - `temperature_offset`) * `temperature_scale` kelvin; voxels of value 0 are dark.
    Grids are voxel-centred over the volume's bounds, as its density is, and of the same size.
    Raises SceneError.
    """

    radiance: Rgb = WHITE
    grid: F32 | None = None
    temperature: F32 | None = None
    temperature_scale: float = 1.0
    temperature_offset: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "radiance", checks.rgb(self.radiance, "emission"))
        put(self, "temperature_scale", checks.number(self.temperature_scale, "temperature_scale"))
        put(self, "temperature_offset", checks.number(self.temperature_offset, "its offset"))
        # What shines is given by a grid or by a temperature, not by both.
        if self.grid is not None and self.temperature is not None:
            raise SceneError(
                "emission has a grid of its own and a temperature", remedy="Leave one of them out."
            )
        if self.grid is not None:
            put(self, "grid", checks.grid(self.grid, "volume emission"))
        if self.temperature is not None:
            put(
                self,
                "temperature",
                checks.grid(self.temperature, "volume temperature", signed=True),
            )
            if self.temperature.ndim != 3:
                raise SceneError("volume temperature must be (z, y, x): one number for each voxel")
            # Negative kelvins are found here, not when a frame needs them.
            _ = self._kelvin

    @property
    def size(self) -> tuple[int, ...] | None:
        """Voxels of its grid (z, y, x), if it has one."""
        own = self.grid if self.temperature is None else self.temperature
        return None if own is None else own.shape[:3]

    @cached_property
    def _kelvin(self) -> F32:
        assert self.temperature is not None
        raw = self.temperature
        # Files hold 0 where there is nothing, whatever their unit.
        kelvin = (raw - np.float32(self.temperature_offset)) * np.float32(self.temperature_scale)
        kelvin[raw == 0.0] = 0.0
        if kelvin.size and float(kelvin.min()) < 0.0:
            raise SceneError(
                f"volume temperature is negative: down to {float(kelvin.min()):g} K",
                remedy="In kelvin it is (value - temperature_offset) * temperature_scale.",
            )
        return kelvin

    @cached_property
    def values(self) -> F32 | None:
        """(z, y, x, 3): what `radiance` is multiplied by in each voxel; None for the density."""
        if self.temperature is not None:
            return rec709_of_grid(self._kelvin)
        return None if self.grid is None else in_rgb(self.grid)

    @cached_property
    def peak(self) -> float:
        """The largest of `values`; 1 without a grid."""
        values = self.values
        return 1.0 if values is None else float(values.max())
