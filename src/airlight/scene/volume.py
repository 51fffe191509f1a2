"""A density grid, or a shape of constant density, that scales a medium's extinction."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from ..errors import SceneError
from . import checks
from .checks import F32, F64, Bounds, Rgb
from .emission import Emission
from .medium import mean_cosine

IDENTITY: F64 = np.eye(4)


@dataclass(frozen=True, eq=False)
class Volume:
    """A heterogeneous medium: extinction sigma_t * density at each point.

    `density` is (z, y, x) float32, dimensionless, >= 0, voxel-centred and trilinear over
    `bounds` (metres); or None with `shape` "box" or "sphere" filling `bounds` with density 1.
    `sigma_t` is per metre at density 1. `world_from_volume` is a rigid or affine 4x4 matrix
    applied after `bounds`. `detail` is the amplitude of procedural noise added at march time.
    `emission` is the light that it gives off itself; its grid, if any, is as large as the density.
    """

    sigma_t: Rgb
    density: F32 | None = None
    shape: Literal["grid", "box", "sphere"] = "grid"
    bounds: Bounds = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    albedo: Rgb = (1.0, 1.0, 1.0)
    g: Rgb = (0.0, 0.0, 0.0)
    world_from_volume: F64 = field(default_factory=lambda: IDENTITY)
    detail: float = 0.0
    source: str = ""
    emission: Emission | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "sigma_t", checks.rgb(self.sigma_t, "sigma_t"))
        put(self, "albedo", checks.rgb(self.albedo, "albedo", high=1.0))
        put(self, "g", mean_cosine(self.g))
        put(self, "bounds", checks.bounds(self.bounds, "volume bounds"))
        put(self, "detail", checks.number(self.detail, "detail", low=0.0, high=10.0))
        matrix = checks.array(
            self.world_from_volume, "volume transform", shape=(4, 4), dtype=np.float64
        )
        put(self, "world_from_volume", matrix)
        if self.shape not in ("grid", "box", "sphere"):
            raise SceneError(f"volume shape '{self.shape}' is unknown", remedy="Use box or sphere.")
        if (self.density is None) == (self.shape == "grid"):
            raise SceneError("a volume needs either a density grid or a shape (box, sphere)")
        if self.density is None and self.detail > 0.0:
            raise SceneError("detail makes a density grid finer, a shape has none")
        if self.density is not None:
            put(self, "density", _checked_density(self.density))
        self._check_emission()

    def _check_emission(self) -> None:
        size = self.emission.size if self.emission else None
        if size is None:
            return
        if self.density is None:
            raise SceneError(
                "a shape has no voxels that an emission grid could light",
                remedy="Give it a density grid, or an emission alone.",
            )
        if size != self.density.shape:
            have, want = (" x ".join(map(str, s[::-1])) for s in (size, self.density.shape))
            raise SceneError(f"volume emission has {have} voxels, its density has {want}")

    @property
    def is_emissive(self) -> bool:
        """Whether it gives off light itself, at this time or another."""
        return self.emission is not None and max(self.emission.radiance) > 0.0


def _checked_density(density: F32) -> F32:
    grid = checks.array(density, "volume density", shape=(None, None, None), dtype=np.float32)
    if grid.size == 0:
        raise SceneError("volume density is empty")
    if grid.min() < 0.0:
        raise SceneError(f"volume density is negative (down to {float(grid.min()):g})")
    checks.at_most(grid, checks.MOST, "volume density")
    # A volume made from another keeps its very array: it need not be uploaded again.
    is_shared = isinstance(density, np.ndarray) and np.shares_memory(density, grid)
    return density if is_shared and not density.flags.writeable else grid
