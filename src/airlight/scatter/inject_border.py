"""Scattered light that comes into the lattice from endless air around it (march.far_air).

Without it the outermost cells of an open scene would be darker than the air beyond them. Only what
was scattered already: beams of suns and of the sky shine into every cell by themselves.
"""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import Placement
from ..march.far_air import scattered_light
from ..maths.transforms import F64
from ..scene.lights import Light
from ..scene.medium import Medium


class BorderParams(Struct):
    """The lattice's size."""

    count = vec3u("cells")
    area = f32("of a cell's face, m^2")


class _AddBorder(ComputePass):
    slots = (
        uniform("params", BorderParams),
        storage("incoming", "vec4f"),
        storage("cells", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "inject_border.wgsl"


class InjectBorder:
    """cells += what comes in through the lattice's sides and its top, W."""

    def __init__(self, gpu: Gpu, placement: Placement) -> None:
        self._pass, self.placement = _AddBorder(gpu), placement
        self._incoming = Buffer(gpu, "incoming light", (placement.count[1] + 1) * 16)
        self._key: object = None

    def encode(
        self, commands: Commands, cells: Buffer, medium: Medium, top: float, lights: list[Light]
    ) -> None:
        """`medium`, endless below the height `top` (m), scatters evenly; `lights` reach it."""
        place = self.placement
        key = (medium, top, tuple(lights))
        if key != self._key:
            self._key = key
            self._incoming.write(incoming_light(place, medium, top, lights).astype(np.float32))
        params = BorderParams(count=place.count, area=place.cell**2)
        self._pass.dispatch(
            commands, place.count, params=params, incoming=self._incoming, cells=cells
        )

    def release(self) -> None:
        """Give the memory back."""
        self._incoming.release()


def incoming_light(place: Placement, medium: Medium, top: float, lights: list[Light]) -> F64:
    """(cells along y + 1, 4), W m^-2: into each layer's sides, then through the lattice's top."""
    rows = np.zeros((place.count[1] + 1, 4))
    heights = place.origin[1] + place.cell * (np.arange(place.count[1]) + 0.5)
    lid = float(place.bounds[1][1])
    for c in range(3):
        light, sigma = scattered_light(medium, lights, c), medium.sigma_t[c]
        sides = np.interp(sigma * (top - heights), light.depth, light.side)
        rows[:-1, c] = np.where(heights < top, sides, 0.0)
        rows[-1, c] = np.interp(sigma * (top - lid), light.depth, light.down) if lid < top else 0.0
    return rows
