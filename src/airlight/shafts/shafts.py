"""Single scattering with texel-sharp volumetric shadows: lit runs of eye rays.

An eye ray is a straight line over each shadow map. A hierarchy of the nearest and farthest depths
lets it cross wholly lit or dark squares at once, as a 2D digital differential analyser that
descends and ascends; adjacent lit stretches are one run, integrated in closed form (parallel
light) or with equi-angular Gauss-Legendre nodes (lamps).
Source: the hierarchy after Chen et al. 2011; NOTES section 2b. differs: Billeter2012 section 3
renders the light volumes of Billeter et al. 2010, whose integral along the ray is the same.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Texture
from ..gpu.slots import image, storage, texture, uniform
from ..lighting.lights import Lights
from ..march.air import Air
from ..march.rays import RayParams, Rays
from ..surface.light_table import LightData
from ..surface.light_views import LightViewData
from .bounds import DepthBounds


class ShaftParams(Struct):
    """How many lights, the sizes of their maps, and how long a ray may take."""

    light_count = u32()
    max_nodes = u32("squares opened or crossed before coarse ones are taken as they are")
    parallel_resolution = u32("texels")
    parallel_side = u32("texels, a power of two")
    parallel_top = u32("level a ray starts at")
    local_resolution = u32("texels")
    local_side = u32("texels, a power of two")
    local_top = u32("level a ray starts at")


class _Shafts(ComputePass):
    workgroup = (8, 8, 1)
    file = "shafts.wgsl"

    def __init__(self, gpu: Gpu, air: Air) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("rays", RayParams), uniform("shafts", ShaftParams),
            texture("picked", "2d", "unfilterable-float"), *air.slots,
            storage("lights", LightData), storage("parallel_views", LightViewData),
            storage("local_views", LightViewData),
            texture("parallel_shadows", "2d-array", "depth"),
            texture("local_shadows", "2d-array", "depth"),
            storage("parallel_bounds", "vec2f"), storage("local_bounds", "vec2f"),
            image("scattered", "rgba32float"),
        )  # fmt: skip
        super().__init__(gpu, generated=air.wgsl)


class Shafts:
    """The scheme `minmax`: for air without density grids."""

    def __init__(self, gpu: Gpu, air: Air, lights: Lights, *, max_nodes: int = 256) -> None:
        self.air, self.max_nodes = air, max_nodes
        self.parallel = DepthBounds(gpu, lights.parallel)
        self.local = DepthBounds(gpu, lights.local)
        self._pass = _Shafts(gpu, air)

    def prepare(self, commands: Commands) -> None:
        """Bring the hierarchies up to date, where shadow maps changed."""
        self.parallel.encode(commands)
        self.local.encode(commands)

    def encode(
        self, commands: Commands, params: RayParams, rays: Rays, lights: Lights,
        scattered: Texture,
    ) -> None:  # fmt: skip
        """Fill `scattered`, of the size of `rays.reduced`: radiance, W m^-2 sr^-1."""
        shafts = ShaftParams(
            light_count=lights.count, max_nodes=self.max_nodes,
            parallel_resolution=self.parallel.maps.depth.size[0],
            parallel_side=self.parallel.side, parallel_top=max(0, self.parallel.top - 3),
            local_resolution=self.local.maps.depth.size[0], local_side=self.local.side,
            local_top=max(0, self.local.top - 3),
        )  # fmt: skip
        self._pass.dispatch(
            commands, rays.reduced, rays=params, shafts=shafts, picked=rays.picked,
            **self.air.bound, lights=lights.table, parallel_views=lights.parallel.views,
            local_views=lights.local.views, parallel_shadows=lights.parallel.depth,
            local_shadows=lights.local.depth, parallel_bounds=self.parallel.buffer,
            local_bounds=self.local.buffer, scattered=scattered,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        self.parallel.release()
        self.local.release()
