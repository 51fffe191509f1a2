"""Paths of a gather: what their segments found, one after the other."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..surface.hits import Hits
from .calibration import RAYS, Calibration
from .guide import LightPatch
from .sky_cells import SkyCells, SkyParams
from .trace import AnyPoints, Segment


class FoldParams(Struct):
    """Which segment it is, and what becomes of the lattices' light on what it met."""

    rays = u32("of a point")
    segment = u32()
    lattices = u32("what becomes of their light, as `fold.wgsl` has it")
    has_forward = u32("whether there is light that media only scatter forwards")
    guided = u32("rays of a point that are led to what lights shine on, beside these")
    counts = f32("for how many of these paths each of those stands that go on")


class Lattices(Enum):
    """What becomes of the lattices' light where a segment ends.

    It is not asked for; or part of the path, as it is; or told beside what the last segment finds;
    or, at the end of that, calibrated by it.
    """

    UNASKED = 0
    ADDED = 1
    TOLD = 2
    LEFT = 3


class SegmentLight(NamedTuple):
    """Textures with the light where a segment ends: of lights; of those that media only scatter
    forwards; and of lattices, which have the second, too."""

    lights: Texture
    forward: Texture | None = None
    lattices: Texture | None = None


# What media add along a segment, and what they let by; row and row + 1 of a buffer.
_NO_AIR = """
fn air_of(row: u32) -> Air { return Air(vec3f(0.0), 0.0, vec3f(1.0)); }
"""
_AIR = """
fn air_of(row: u32) -> Air { return Air(air[row].rgb, air[row].a, air[row + 1u].rgb); }
"""
_SLOTS = (
    uniform("params", FoldParams),
    uniform("sky", SkyParams),
    texture("starts", "2d", "unfilterable-float"),
    texture("normals", "2d", "unfilterable-float"),
    texture("hit_positions", "2d", "unfilterable-float"),
    texture("hit_normals", "2d", "unfilterable-float"),
    texture("hit_albedos", "2d", "unfilterable-float"),
    texture("direct_light", "2d", "unfilterable-float"),
    texture("forward_light", "2d", "unfilterable-float"),
    texture("lattice_light", "2d", "unfilterable-float"),
    storage("sky_cells", "vec4f"),
    storage("lit_patches", LightPatch),
    storage("paths", "vec4f", "read_write"),
    storage("met", "u32", "read_write"),
    storage("shares", "vec4f", "read_write"),
)


class _Fold(ComputePass):
    workgroup = (8, 8, 1)
    in_bands = True

    def __init__(self, gpu: Gpu, *, has_air: bool) -> None:
        self.slots = _SLOTS + (storage("air", "vec4f"),) * has_air
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
        # Of each ray its light and what still passes, the side that it met, and media along it.
        nbytes = 32 * points.count * batch
        self.buffer = Buffer(gpu, "gathered paths", nbytes)
        self.met = Buffer(gpu, "sides that paths met", 4 * points.count * batch)
        self.air = Buffer(gpu, "air along paths", nbytes) if has_air else None
        self.calibration = Calibration(gpu, points.count * batch)

    def encode(
        self,
        commands: Commands,
        hits: Hits,
        light: SegmentLight,
        segment: Segment,
        rays: int,
        lattices: Lattices,
        guide: tuple[Buffer, int],
    ) -> None:
        """Add the `light` of the `hits` of a segment.

        `rays`: of a point, in this sample of the image. `lattices`: what becomes of theirs.
        `guide`: the patches that lead other rays of points, and how many of these there are.
        """
        # Points add up what their rays met: light of surfaces, of media on the path, and the
        # lattice's where a path ends.
        self._fold.dispatch(
            commands,
            (self._points.reduced[0], self._points.reduced[1] * len(segment.numbers)),
            params=FoldParams(
                rays=len(segment.numbers),
                segment=segment.index,
                lattices=lattices.value,
                has_forward=int(light.forward is not None),
                guided=guide[1],
                counts=segment.counts,
            ),
            sky=self._cells.params(self._points, rays, 0),
            starts=self._points.starts,
            normals=self._points.normals,
            hit_positions=hits.positions,
            hit_normals=hits.normal,
            hit_albedos=hits.albedo,
            direct_light=light.lights,
            forward_light=light.forward or light.lights,
            lattice_light=light.lattices or light.lights,
            sky_cells=self._cells.buffer,
            lit_patches=guide[0],
            paths=self.buffer,
            met=self.met,
            shares=self.calibration.shares,
            **({"air": self.air} if self.air else {}),
        )
        if lattices is Lattices.LEFT:
            self._calibrate(commands, segment, rays)

    def _calibrate(self, commands: Commands, segment: Segment, rays: int) -> None:
        """Add the lattices' light at the ends of paths, by the factor of the sample's first."""
        points, numbers = self._points.reduced[0] * self._points.reduced[1], segment.numbers
        # The sample's first rays measure it, whatever a batch holds.
        if numbers.start % rays == 0:
            self.calibration.measure(commands, points * min(len(numbers), RAYS))
        self.calibration.apply(commands, self.buffer, points * len(numbers))
