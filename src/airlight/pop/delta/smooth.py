"""What cells scatter towards the eye on cells half as wide, for marching.

Source: Elek2014 section 5.3, which merges its grids in one of double the resolution, upsampled by
joint bilateral weights of the density. differs: cubic splines, which came nearer to Monte Carlo
(docs/notebook.md); the density is marched at its own resolution anyway.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Buffer, Texture
from ...gpu.slots import image, storage, texture, uniform
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams


class _Smooth(ComputePass):
    slots = (
        uniform("params", MediumParams),
        texture("emission", "3d", "unfilterable-float"),
        storage("reach", "u32"),
        storage("walls", "u32"),
        image("halved", "rgba16float", "3d"),
    )
    workgroup = (4, 4, 4)
    file = "smooth.wgsl"


class SmoothEmission:
    """Fills `texture`, of two texels along a cell, from the emission of cells."""

    TEXELS = 2

    def __init__(self, medium: GridMedium) -> None:
        self._medium = medium
        nx, ny, nz = medium.placement.count
        size = (self.TEXELS * nx, self.TEXELS * ny, self.TEXELS * nz)
        self.texture = Texture(
            medium.gpu, "smooth emission", size, "rgba16float", dimension="3d", written=True
        )
        self._pass = _Smooth(medium.gpu)

    def encode(
        self, commands: Commands, params: MediumParams, emission: Texture, walls: Buffer
    ) -> None:
        """Interpolate the `emission` of the cells that light reaches, up to `walls`."""
        with commands.stage("pop emission"):
            self._pass.dispatch(
                commands,
                self.texture.size,
                params=params,
                emission=emission,
                reach=self._medium.density.reach,
                walls=walls,
                halved=self.texture,
            )
