"""All light in a lattice's cells, as the rays of a final gather meet it in the air.

Marching towards the eye draws light that is scattered once sharply, and reads from the lattice what
is scattered more often. A gather's rays need no such sharpness: they read one mean radiance of the
reduced medium, that of the solved track and of the unscattered light of lights and sky together.
What the reduced medium does not scatter (light that goes on forwards) lights surfaces as
`scatter.forward` has it, in textures of its own (`surface_beams`).
"""

from __future__ import annotations

import math
from typing import Any

from ..fields import AirLight, AirLobes, LatticeSource
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import FILTERED, image, storage, uniform
from ..lighting.kit import Kit
from ..maths.half import half_scale
from ..maths.lattice26 import true_share
from ..scene.checks import Rgb
from .cascades import Cascade


class LightInAirParams(Struct):
    """The lattice's size and scales."""

    count = vec3u("cells")
    scale = f32("stored units per W m of track")
    share = vec3f("of the lattice's track that there truly is")
    volume = f32("m^3, of a cell")
    first_row = u32("where its cells begin along y of the texture")


class _Pack(ComputePass):
    slots = (
        uniform("params", LightInAirParams),
        storage("track", "vec4f"),
        storage("light", "vec4f"),
        image("mean", FILTERED, "3d"),
        image("straight", FILTERED, "3d"),
        image("along", FILTERED, "3d"),
    )
    workgroup = (32, 8, 1)
    file = "light_in_air.wgsl"


class LightInAir:
    """The mean radiance of all light."""

    def __init__(self, gpu: Gpu, kit: Kit) -> None:
        self._kit, self._pack, self.scale = kit, _Pack(gpu), 1.0
        size = kit.lattices.texture_size
        # All light; the part of it that is unscattered, and where that goes; of the rest, which
        # comes from all sides, no direction is known.
        self._mean, self._straight, self._along, self._turned = (
            Texture(gpu, name, size, FILTERED, dimension="3d", written=True)
            for name in (
                "light in air",
                "unscattered light in air",
                "where it goes",
                "where scattered light goes",
            )
        )

    def encode(
        self, commands: Commands, part: Cascade, track: Buffer, flux: float, sigma_t: Rgb
    ) -> None:
        """Fill the textures' part of a lattice; `flux`, W, bounds what came into it.

        `sigma_t`, m^-1, as for `Emission`.
        """
        # Scaled as `Emission` scales: finer cells have smaller faces, of which marching knows.
        largest, place = self._kit.placement.cell, part.placement
        self.scale = half_scale(flux * largest)
        # All light and its unscattered part, as mean radiance of each cell.
        self._pack.dispatch(
            commands,
            place.count,
            params=LightInAirParams(
                count=place.count,
                scale=self.scale * largest / place.cell,
                share=true_share(sigma_t, place.cell).tolist(),
                volume=place.cell**3,
                first_row=place.first_row,
            ),
            track=track,
            light=part.injection.light_in_cells,
            mean=self._mean,
            straight=self._straight,
            along=self._along,
        )

    def field(self, walls: dict[str, Any]) -> AirLight:
        """For the rays of a gather; `walls` as Blockers.bound."""
        largest, places = self._kit.placement, self._kit.lattices.placements
        # The slots of channels want textures; rays read the mean alone.
        mean = LatticeSource(
            largest,
            {f"lattice_{name}": self._mean for name in ("red", "green", "blue")} | walls,
            1.0 / (4.0 * math.pi * largest.cell**3 * self.scale),
            finer=places[:-1],
            mean=self._mean,
        )
        return AirLight(mean, AirLobes(self._straight, self._along, self._turned))
