"""Blockers from six shadow maps around the scene (Billeter2012 section 5).

A map along an axis covers cell faces across that axis, each texel by its own area, so that a
slanted surface is not counted by two of them. What lies behind the first surface is not seen:
rooms block as their outside does, and what stands in a closed room does not block.
differs: the texels go into the non-negative sums of lattice.blockers, not into spherical
harmonics; a surface counts from both sides, for a wall's far side may be unseen.
"""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..gpu.slots import storage, texture, uniform
from ..lattice.blockers import UNITS, Blockers
from ..lattice.placement import Placement
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.light_views import LightViewData, light_views
from ..surface.reflective import ReflectiveShadowMaps

_WHITE = (1.0, 1.0, 1.0)
VIEWS: tuple[Light, ...] = tuple(
    DirectionalLight(tuple(np.eye(3)[axis] * sign), _WHITE)
    for axis in range(3)
    for sign in (-1.0, 1.0)
)
"""What the maps look along: -x +x -y +y -z +z. A white light's flux is the reflectance."""


class MapParams(Struct):
    """Where corners are, and the size of the maps."""

    origin = vec3f("m")
    cell = f32("m")
    count = vec3u("cells")
    resolution = u32("texels")
    units = f32("fixed-point units per fully covered face")


class _SumTexels(ComputePass):
    slots = (
        uniform("params", MapParams),
        storage("views", LightViewData),
        texture("depth", "2d-array", "depth"),
        texture("flux", "2d-array", "unfilterable-float"),
        storage("sums", "atomic<i32>", "read_write"),
    )
    workgroup = (16, 16, 1)
    file = "map_blockers.wgsl"


class MapBlockers(Blockers):
    """As lattice.blockers.Blockers, which it replaces; glowing surfaces are still its surfels."""

    def __init__(
        self,
        gpu: Gpu,
        scene: Scene,
        meshes: GpuScene,
        placement: Placement,
        count: int,
        *,
        resolution: int,
        size: tuple[int, int, int] | None = None,
    ) -> None:
        """`resolution`: texels along a map's side."""
        super().__init__(gpu, scene, meshes, placement, count, size=size)
        self.maps = ReflectiveShadowMaps(gpu, "blockers", resolution, len(VIEWS))
        self._texels = _SumTexels(gpu)

    def sum_meshes(self, commands: Commands) -> None:
        """Add what the maps see to the sums around the corners."""
        self.follow_vertices()
        if not self.meshes.draws:
            return
        views = light_views(VIEWS, *self.meshes.bounds, self.maps.resolution)
        self.maps.encode(commands, self.meshes, VIEWS, views)
        place, side = self.placement, self.maps.resolution
        self._texels.dispatch(
            commands,
            (side, side, len(VIEWS)),
            params=MapParams(
                origin=place.origin,
                cell=place.cell,
                count=place.count,
                resolution=side,
                units=UNITS,
            ),
            views=self.maps.views,
            depth=self.maps.depth,
            flux=self.maps.flux,
            sums=self.sums,
        )
