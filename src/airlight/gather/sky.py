"""Rays towards what is bright of the environment.

Rays by the cosine find a uniform sky, and a small sun by luck alone; rays by brightness find it.
Both are sent and weighted by how likely either would have been (`maths.gather.sky_share`).
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.slots import storage, texture, uniform
from ..media.gpu_media import GpuMedia
from ..rays.rays import RAY_SLOTS, RayScene
from .points import Points
from .sky_cells import SkyCells, SkyParams
from .sums import PointSums, Sums

# The share of the sky's light that media let by.
_ALL_PASSED = """
fn sky_passed(origin: vec3f, direction: vec3f) -> vec3f { return vec3f(1.0); }
"""
_PASSED = """
//! use media
fn sky_passed(origin: vec3f, direction: vec3f) -> vec3f {
    return exp(-media_optical_depth(origin, direction, 0.0, MEDIUM_FAR));
}
"""


class _SkyRays(ComputePass):
    workgroup = (8, 8, 1)
    in_bands = True

    def __init__(self, gpu: Gpu, media: GpuMedia | None, constants: dict[str, float]) -> None:
        self.slots = (
            uniform("sky", SkyParams),
            texture("starts", "2d", "unfilterable-float"),
            texture("normals", "2d", "unfilterable-float"),
            *RAY_SLOTS,
            *(media.medium_slots if media else ()),
            storage("sky_cells", "vec4f"),
            storage("sums", PointSums, "read_write"),
        )
        # Media attenuate the sky along these rays; their own light is met by others.
        passed = media.medium_wgsl + _PASSED if media else _ALL_PASSED
        super().__init__(gpu, generated=passed, constants=constants)

    file = "sky.wgsl"


class SkyRays:
    """Sends rays towards bright `cells` of the environment, through `media`."""

    def __init__(
        self, gpu: Gpu, scene: RayScene, cells: SkyCells, media: GpuMedia | None = None
    ) -> None:
        self._scene, self._cells = scene, cells
        self._pass = _SkyRays(gpu, media, scene.constants)
        self._media = media

    def encode(
        self, commands: Commands, points: Points, sums: Sums, rays: int, sample: int
    ) -> None:
        """Add what they find to the `sums` of points with `rays` by the cosine."""
        # A uniform sky needs no rays towards it.
        if not self._cells.count(rays):
            return
        self._pass.dispatch(
            commands,
            points.reduced,
            sky=self._cells.params(points, rays, sample),
            starts=points.starts,
            normals=points.normals,
            **self._scene.bound,
            **(self._media.medium_bound if self._media else {}),
            sky_cells=self._cells.buffer,
            sums=sums.buffer,
        )
