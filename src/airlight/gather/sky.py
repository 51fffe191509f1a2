"""Rays towards what is bright of the environment.

Rays by the cosine find a uniform sky, and a small sun by luck alone; rays by brightness find it.
Both are sent and weighted by how likely either would have been (`maths.gather.sky_share`).
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.slots import storage, texture, uniform
from ..rays.rays import RAY_SLOTS, RayScene
from .points import Points
from .sky_cells import SkyCells, SkyParams
from .sums import Sums


class _SkyRays(ComputePass):
    slots = (
        uniform("sky", SkyParams),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        *RAY_SLOTS,
        storage("sky_cells", "vec4f"),
        storage("sums", "vec4f", "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "sky.wgsl"


class SkyRays:
    """Sends rays towards bright `cells` of the environment."""

    def __init__(self, gpu: Gpu, scene: RayScene, cells: SkyCells) -> None:
        self._scene, self._cells = scene, cells
        self._pass = _SkyRays(gpu, constants=scene.constants)

    def encode(
        self, commands: Commands, points: Points, sums: Sums, rays: int, sample: int
    ) -> None:
        """Add what they find to the `sums` of points with `rays` by the cosine."""
        if not self._cells.count(rays):
            return
        self._pass.dispatch(
            commands,
            points.reduced,
            sky=self._cells.params(points, rays, sample),
            places=points.places,
            normals=points.normals,
            **self._scene.bound,
            sky_cells=self._cells.buffer,
            sums=sums.buffer,
        )
