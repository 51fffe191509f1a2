"""A homogeneous medium around others, which a lattice solves: its transmittance of their light.

The lattice has the light that it scatters, as its reduced medium does (`media.reduced`); so what
reaches the others unscattered in that medium is attenuated by its extinction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...maths.transforms import F64
from ...scene.checks import Rgb
from .placement import MediumPlacement


@dataclass(frozen=True)
class SurroundingMedium:
    """A box `low`..`high` (m, of the world) of a reduced medium's extinction `sigma_t`, m^-1."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    sigma_t: Rgb

    def fields(self, placement: MediumPlacement) -> dict[str, Any]:
        """Its fields of `MediumParams`, for a medium that is placed so."""
        # From the medium's frame to 0..1 in its box.
        low, high = np.array(self.low), np.array(self.high)
        unit_from_world: F64 = np.diag([*(1.0 / np.maximum(high - low, 1e-30)), 1.0])
        unit_from_world[:3, 3] = -low * unit_from_world.diagonal()[:3]
        return {
            "surrounding_from_medium": unit_from_world @ placement.world_from_medium,
            "surrounding_sigma_t": self.sigma_t,
        }
