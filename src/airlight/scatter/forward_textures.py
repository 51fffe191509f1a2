"""Each light's forward light in the cells of all lattices, as textures for marching.

Nested lattices lie one above the other along y, as in all textures that they share; light lies
behind light along z.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..fields import FORWARD_REACH, ForwardSource
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.rows import Table
from ..gpu.slots import image, storage, texture, uniform
from ..lattice.placement import Placement
from ..maths.half import half_scale
from ..scene.lights import AreaLight, DirectionalLight, Light


class BlurParams(Struct):
    """What is averaged, and along which axis."""

    count = vec3u("cells")
    lights = u32()
    axis = u32()
    first_row = u32("where the lattice's cells begin along y of the textures")
    depth = u32("cells along z of the textures that each light has")


class Blur(ComputePass):
    """The mean of a light over cells along one axis, as far as the faces between are open."""

    slots = (
        uniform("params", BlurParams),
        storage("face_visibility", "vec2u"),
        texture("light", "3d"),
        image("blurred", "rgba16float", "3d"),
    )
    workgroup = (32, 4, 2)
    file = "forward_blur.wgsl"


class ForwardTextures:
    """The textures: `unblurred`, `blurred` over FORWARD_REACH cells to each side."""

    def __init__(
        self, gpu: Gpu, placements: Sequence[Placement], size: tuple[int, int, int], lights: int
    ) -> None:
        """`placements` of all lattices, the finest first; `size`: cells of all, of one light."""
        self.lights, self.depth = lights, size[2]
        self._finest_m, self._largest_m = placements[0].cell, placements[-1].cell
        # Each light has a slab of cells along z.
        whole = (size[0], size[1], size[2] * max(1, lights))
        self.unblurred, self.blurred, self._between = (
            Texture(gpu, name, whole, "rgba16float", dimension="3d", written=True)
            for name in ("forward light by light", "blurred forward light", "half blurred light")
        )
        self._blur = Blur(gpu, generated=f"const REACH = {FORWARD_REACH}u;")
        self.scale = 1.0

    def set_scale(self, lights: Sequence[Light]) -> None:
        """Choose what is stored per W m^-2 of light."""
        self.scale = _scale(lights, self._finest_m)

    def encode_blur(
        self, commands: Commands, placement: Placement, lights: int, face_visibility: Buffer
    ) -> None:
        """Fill `blurred` from `unblurred` in the cells of one lattice."""
        x, y, z = placement.count
        # Along x, y and z in turn.
        unblurred, blurred, between = self.unblurred, self.blurred, self._between
        for axis, (light, target) in enumerate(
            ((unblurred, blurred), (blurred, between), (between, blurred))
        ):
            self._blur.dispatch(
                commands,
                (x, y, z * lights),
                params=BlurParams.of(
                    count=placement.count,
                    lights=lights,
                    axis=axis,
                    first_row=placement.first_row,
                    depth=self.depth,
                ),
                face_visibility=face_visibility,
                light=light,
                blurred=target,
            )

    def source(self, table: Table) -> ForwardSource:
        """For marching; `table` of lights."""
        count = self.lights
        return ForwardSource(
            self.unblurred,
            self.blurred,
            table,
            count,
            max(1, count),
            1.0 / self.scale,
            self._largest_m,
        )


def _scale(lights: Sequence[Light], cell_size_m: float) -> float:
    """Stored units per W m^-2: no light half a cell away is too bright for half floats."""
    largest = max(
        (
            max(x.irradiance)
            if isinstance(x, DirectionalLight)
            else max(x.intensity) / (0.5 * cell_size_m) ** 2
            for x in lights
            if not isinstance(x, AreaLight)
        ),
        default=0.0,
    )
    return half_scale(largest)
