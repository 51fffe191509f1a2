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
from ..gpu.layout import Struct, f32, u32
from ..gpu.rows import table
from ..gpu.slots import storage, texture, uniform
from ..lattice.blockers import UNITS, Blockers
from ..lattice.placement import Axes, LatticeParams, Placement
from ..maths.transforms import triple
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.light_views import LightViewData, light_views
from ..surface.reflective import ReflectiveShadowMaps

# Under light of 1 the flux of a map is what it shows reflects.
_WHITE = (1.0, 1.0, 1.0)
VIEWS = 6
"""How many maps there are."""


def views_along(axes: Axes) -> tuple[Light, ...]:
    """What the maps look along: -x +x -y +y -z +z of a lattice. A white light's flux is the
    reflectance.
    """
    return tuple(
        DirectionalLight(triple(np.array(axis) * sign), _WHITE)
        for axis in axes
        for sign in (-1.0, 1.0)
    )


class MapParams(Struct):
    """The size of the maps, and how area becomes integers."""

    resolution = u32("texels")
    units = f32("fixed-point units per fully covered face")


class _SumTexels(ComputePass):
    slots = (
        uniform("params", MapParams),
        uniform("lattice", LatticeParams),
        table("views", LightViewData),
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
        self.maps = ReflectiveShadowMaps(gpu, "blockers", resolution, VIEWS)
        self._texels = _SumTexels(gpu)

    def sum_meshes(self, commands: Commands) -> None:
        """Add what the maps see to the sums around the corners."""
        self.follow_vertices()
        if not self.meshes.draws:
            return
        # What six white lights from outside see, then its texels into the sums.
        lights = views_along(self.placement.axes)
        views = light_views(lights, *self.meshes.bounds, self.maps.resolution)
        self.maps.encode(commands, self.meshes, lights, views)
        placement, side = self.placement, self.maps.resolution
        self._texels.dispatch(
            commands,
            (side, side, VIEWS),
            params=MapParams(resolution=side, units=UNITS),
            lattice=placement.params(),
            views=self.maps.views,
            depth=self.maps.depth,
            flux=self.maps.flux,
            sums=self.sums,
        )
