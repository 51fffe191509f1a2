"""Rays towards what lights shine on.

Rays by the cosine find a small lit patch by luck, and those towards it find it; both are sent, and
weighted by how likely either would have been (`maths.light_guide`). Only the light of lights on
what the first segments meet is shared so: all else is left to rays by the cosine.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec2u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..lighting.lighting import RadianceLayers
from ..surface.hits import Hits
from .guide import LightPatch
from .points import Points
from .sums import PointSums

# What air lets by and adds along a ray, where there is any.
_ALL_PASSED = """
fn passed_by_ray(row: u32) -> vec3f { return vec3f(1.0); }
"""
_PASSED = """
fn passed_by_ray(row: u32) -> vec3f { return air[row + 1u].rgb; }
"""


class GuidedParams(Struct):
    """How many points and rays of each kind there are."""

    reduced = vec2u("points")
    rays = u32("of a point, by the cosine")
    guided = u32("of a point, towards what lights shine on")


class _GuidedSums(ComputePass):
    workgroup = (8, 8, 1)
    in_bands = True

    def __init__(self, gpu: Gpu, *, has_air: bool) -> None:
        self.slots = (
            uniform("params", GuidedParams),
            texture("starts", "2d", "unfilterable-float"),
            texture("normals", "2d", "unfilterable-float"),
            texture("hit_positions", "2d", "unfilterable-float"),
            texture("direct_light", "2d", "unfilterable-float"),
            storage("lit_patches", LightPatch),
            *((storage("air", "vec4f"),) * has_air),
            storage("sums", PointSums, "read_write"),
        )
        super().__init__(gpu, generated=_PASSED if has_air else _ALL_PASSED)

    file = "guided_sums.wgsl"


class GuidedRays:
    """`hits` and `layers` of the guided rays of a view's points; `count`: of each in a sample."""

    def __init__(self, gpu: Gpu, points: Points, rays: int, count: int, *, has_air: bool) -> None:
        """`rays`: of a point, by the cosine."""
        self._points, self._rays = points, rays
        # As many rays as an image of hits has rows for.
        width, height = points.reduced
        self.count = min(count, gpu.limits["max-texture-dimension-2d"] // height)
        size = (width, height * max(1, self.count))
        self.hits, self.layers = Hits(gpu, size), RadianceLayers(gpu, size)
        self.air = Buffer(gpu, "air along guided rays", 32 * size[0] * size[1]) if has_air else None
        self._pass = _GuidedSums(gpu, has_air=has_air)

    def encode(self, commands: Commands, light: Texture, patches: Buffer, sums: Buffer) -> None:
        """Add the `light` of lights on what they met to `sums`."""
        # Rays by the cosine may find the same light; the balance heuristic shares it.
        self._pass.dispatch(
            commands,
            self._points.reduced,
            params=GuidedParams(reduced=self._points.reduced, rays=self._rays, guided=self.count),
            starts=self._points.starts,
            normals=self._points.normals,
            hit_positions=self.hits.positions,
            direct_light=light,
            lit_patches=patches,
            **({"air": self.air} if self.air else {}),
            sums=sums,
        )
