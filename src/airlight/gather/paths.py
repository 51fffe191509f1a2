"""Paths of a gather: what their segments found, one after the other."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..surface.hits import Hits
from .sky_cells import SkyCells, SkyParams
from .trace import AnyPoints, Segment


class FoldParams(Struct):
    """Which segment it is, and whether lattices' light is on what it met."""

    rays = u32("of a point")
    segment = u32()
    has_cache = u32()
    pad = u32()


_NO_AIR = """
fn air_of(row: u32) -> Air { return Air(vec3f(0.0), 0.0, vec3f(1.0)); }
"""
_AIR = """
fn air_of(row: u32) -> Air { return Air(air[row].rgb, air[row].a, air[row + 1u].rgb); }
"""
_SLOTS = (
    uniform("params", FoldParams),
    uniform("sky", SkyParams),
    texture("places", "2d", "unfilterable-float"),
    texture("normals", "2d", "unfilterable-float"),
    texture("hit_positions", "2d", "unfilterable-float"),
    texture("hit_normals", "2d", "unfilterable-float"),
    texture("hit_albedos", "2d", "unfilterable-float"),
    texture("direct_light", "2d", "unfilterable-float"),
    texture("indirect_light", "2d", "unfilterable-float"),
    storage("sky_cells", "vec4f"),
    storage("paths", "vec4f", "read_write"),
    storage("met", "u32", "read_write"),
)


class _Fold(ComputePass):
    workgroup = (8, 8, 1)

    def __init__(self, gpu: Gpu, *, has_air: bool) -> None:
        self.slots = _SLOTS + (storage("air", "vec4f"),) * has_air  # type: ignore[misc]
        super().__init__(gpu, generated=_AIR if has_air else _NO_AIR)

    file = "fold.wgsl"


class Paths:
    """Two vec4f for each ray of a batch, as `fold.wgsl` has them; and two of the `air` along it.

    `met`: in 4 bytes, which side of a surface its first segment met, and how far media attenuated
    it.
    """

    def __init__(
        self, gpu: Gpu, points: AnyPoints, cells: SkyCells, batch: int, *, has_air: bool = False
    ) -> None:
        """For `batch` rays of each point. `has_air`: there are media in their way."""
        self._points, self._cells, self._fold = points, cells, _Fold(gpu, has_air=has_air)
        nbytes = 32 * points.count * batch
        self.buffer = Buffer(gpu, "gathered paths", nbytes)
        self.met = Buffer(gpu, "sides that paths met", 4 * points.count * batch)
        self.air = Buffer(gpu, "air along paths", nbytes) if has_air else None

    def encode(
        self,
        commands: Commands,
        hits: Hits,
        light: tuple[Texture, Texture | None],
        segment: Segment,
        rays: int,
    ) -> None:
        """Add the `light` of the `hits` of a segment: that of lights, and perhaps of lattices.

        `rays`: of a point, in this sample of the image.
        """
        direct, indirect = light
        self._fold.dispatch(
            commands,
            (self._points.reduced[0], self._points.reduced[1] * len(segment.numbers)),
            params=FoldParams(
                rays=len(segment.numbers),
                segment=segment.index,
                has_cache=int(indirect is not None),
                pad=0,
            ),
            sky=self._cells.params(self._points, rays, 0),
            places=self._points.places,
            normals=self._points.normals,
            hit_positions=hits.positions,
            hit_normals=hits.normal,
            hit_albedos=hits.albedo,
            direct_light=direct,
            indirect_light=indirect or direct,
            sky_cells=self._cells.buffer,
            paths=self.buffer,
            met=self.met,
            **({"air": self.air} if self.air else {}),
        )
