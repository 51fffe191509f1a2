"""The summed states as textures, for lighting surfaces as lattice.lookup's are.

Light scattered once starts in a cell and has half a hop behind it when it reaches the cell's own
walls: it counts half. Air shortens the track that a state leaves, and so the light that reaches a
wall, by mean_track's share.
"""

from __future__ import annotations

import math

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import image, storage, uniform
from ..lattice.placement import LatticeParams, Placement
from ..maths.lattice26 import LOOKUP_SCALE, mean_hop_length
from ..scene.checks import Rgb
from .hop_wgsl import constants, mean_track

_LARGEST = 1000.0  # what all flux in one cell becomes; half floats go to 65504


class SurfaceLightParams(Struct):
    """The lattice's size, its scale and its air."""

    count = vec3u("cells")
    cell = f32("m")
    sigma_t = vec3f("m^-1, where the air is even")
    scale = f32("stored units per W of state in clear air, and per m of mean track there")
    is_varied = u32()


class _Pack(ComputePass):
    slots = (
        uniform("params", SurfaceLightParams),
        storage("total", "vec4f"),
        storage("source", "vec4f"),
        storage("reflected", "vec4f"),
        storage("medium", "vec2f"),
        image("red", "rgba16float", "3d"),
        image("green", "rgba16float", "3d"),
        image("blue", "rgba16float", "3d"),
    )
    workgroup = (32, 8, 1)
    file = "surface_light.wgsl"


class SurfaceLight:
    """Three textures that `wgsl/lattice.wgsl` reads."""

    def __init__(self, gpu: Gpu, placement: Placement) -> None:
        self.placement, self.scale = placement, 1.0
        self._pack = _Pack(gpu, generated=f"{constants()}\n{mean_track()}")
        self.red, self.green, self.blue = (
            Texture(gpu, f"surface {name}", placement.count, "rgba16float", dimension="3d",
                    written=True)
            for name in ("red", "green", "blue")
        )  # fmt: skip

    def encode(
        self, commands: Commands, total: Buffer, source: Buffer, reflected: Buffer, flux: float, *,
        medium: Buffer | None, sigma_t: Rgb,
    ) -> None:  # fmt: skip
        """From the sum of states, the injected light, and what of it surfaces reflected.

        `flux`, W, bounds what came in; `medium` as for VariedStep, or None for even `sigma_t`.
        """
        self.scale = float(2.0 ** math.floor(math.log2(_LARGEST / max(flux, 1e-30))))
        clear_m = mean_hop_length() * self.placement.cell
        params = SurfaceLightParams(
            count=self.placement.count, cell=self.placement.cell, sigma_t=sigma_t,
            scale=self.scale / clear_m, is_varied=int(medium is not None),
        )  # fmt: skip
        self._pack.dispatch(
            commands, self.placement.count, params=params, total=total, source=source,
            reflected=reflected, medium=medium or total, red=self.red, green=self.green,
            blue=self.blue,
        )  # fmt: skip

    def params(self) -> LatticeParams:
        """The `lattice` with which wgsl/lattice.wgsl reads irradiance off these textures."""
        # Textures hold power, lattice.wgsl reads intensity.
        return self.placement.params(self.scale * 4.0 * math.pi, lookup_scale=LOOKUP_SCALE)

    @property
    def bound(self) -> dict[str, Texture]:
        """By slot name, for passes that use `wgsl/lattice.wgsl`."""
        return {"lattice_red": self.red, "lattice_green": self.green, "lattice_blue": self.blue}

    def release(self) -> None:
        """Give the memory back."""
        for texture in (self.red, self.green, self.blue):
            texture.release()
