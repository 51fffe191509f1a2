"""The environment's direct light on surfaces, with its shadows: an ambient cube per cell.

For each cell and each sky light, depth maps say how much of the light arrives; the irradiance
on the six axis directions is stored (McTaggart2004) and blended by the squared normal. Low
frequency by construction, but occluded: a room without windows stays dark.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, pack_array, u32, vec4f
from ..gpu.memory import Buffer, Sampler, Texture
from ..gpu.slots import image, sampler, storage, texture, uniform
from ..scene.lights import DirectionalLight
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps
from .placement import LatticeParams, Placement

FACES = 6  # +x -x +y -y +z -z, stacked along the texture's z


class SkylightParams(Struct):
    """How many sky lights there are."""

    lights = u32()


class SkyLightData(Struct):
    """One sky light."""

    direction = vec4f("of travel; w unused")
    irradiance = vec4f("W m^-2; w unused")


class _Skylight(ComputePass):
    slots = (
        uniform("params", SkylightParams),
        uniform("lattice", LatticeParams),
        storage("sky", SkyLightData),
        storage("views", LightViewData),
        texture("depth", "2d-array", "depth"),
        sampler("compare", "comparison"),
        texture("lattice_walls", "3d"),
        image("cube", "rgba16float", "3d"),
    )
    workgroup = (8, 8, 4)
    file = "skylight.wgsl"


class Skylight:
    """The ambient cubes of one lattice; made anew only where light or geometry changed."""

    def __init__(
        self, gpu: Gpu, placement: Placement, capacity: int, *,
        size: tuple[int, int, int] | None = None, beside: Skylight | None = None,
    ) -> None:  # fmt: skip
        """For up to `capacity` lights. `size`: in cells, of a texture that nested lattices share
        (the lattice's own if not given); `beside`: the one of them that owns the texture.
        """
        self.placement, self._is_owner = placement, beside is None
        nx, ny, nz = size or placement.count
        self.cube = beside.cube if beside else Texture(
            gpu, "sky light", (nx, ny, FACES * nz), "rgba16float", dimension="3d", written=True
        )  # fmt: skip
        self._lights = Buffer(gpu, "sky lights", SkyLightData.dtype.itemsize * max(1, capacity))
        self._pass = _Skylight(gpu)

    def encode(
        self, commands: Commands, lights: Sequence[DirectionalLight], maps: ReflectiveShadowMaps,
        compare: Sampler, walls: Texture,
    ) -> None:  # fmt: skip
        """Fill the cubes from the depth maps of `lights`."""
        rows = [
            {"direction": (*light.direction, 0.0), "irradiance": (*light.irradiance, 0.0)}
            for light in lights
        ]
        self._lights.write(pack_array(SkyLightData, rows))
        self._pass.dispatch(
            commands, self.placement.count, params=SkylightParams(lights=len(lights)),
            lattice=self.placement.params(), sky=self._lights, views=maps.views,
            depth=maps.depth, compare=compare, lattice_walls=walls, cube=self.cube,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        if self._is_owner:
            self.cube.release()
        self._lights.release()
