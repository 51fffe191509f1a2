"""Virtual point lights injected into cells (Kaplanyan2010 section 3.1), bit-reproducible.

Sums are in fixed point, with integer atomics, and so do not depend on the order of additions. The
scale follows from the total flux, so that even all of it in one cell fits.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Buffer
from ..gpu.rows import Table, table
from ..gpu.slots import Slot, storage, texture, uniform
from ..maths.lattice6 import hops
from ..scene.lights import Light
from ..surface.light_table import LightData
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps
from .lobes import SHAPED_LOBE, TARGET_SLOTS, InjectionTarget, Lobe
from .placement import Placement

_HEADROOM_BITS = 30


class InjectParams(Struct):
    """The size of the maps, and the sizes below which objects are left out."""

    resolution = u32("texels")
    layers = u32()
    block = u32("texels along each side of a block, which is injected as a whole")
    least = f32("m, objects up to this size are left out, wholly in from half as much more on")
    next_least = f32("m, the same for the next larger lattice")
    has_static = u32("1: objects that never moved are left out like others")


@dataclass(frozen=True)
class SmallObjects:
    """Which objects a lattice leaves out (Kaplanyan2010 section 4).

    Objects up to the size `least`, metres, are left out; those up to `next_least`, which are too
    small for the next larger lattice, fade out towards this lattice's border. `has_static`: objects
    that never moved are left out, too, though their light cannot flicker.

    differs: the paper leaves all small objects out.
    """

    least: float = 0.0
    next_least: float = 0.0
    has_static: bool = False


EVERYTHING = SmallObjects()
"""Nothing is left out."""


class LightAttenuation(Protocol):
    """Media as passes bind them that use `wgsl/media_light.wgsl`."""

    slots: tuple[Slot, ...]
    wgsl: str

    @property
    def bound(self) -> dict[str, Any]:
        """The resources, by slot name."""


@dataclass(frozen=True, eq=False)
class MapLights:
    """Whose light maps show: the `table` of lights, and each layer's row in it (`owners`)."""

    table: Table
    owners: Buffer

    @property
    def bound(self) -> dict[str, Any]:
        """By the names of MAP_LIGHT_SLOTS."""
        return {"lights": self.table, "owners": self.owners}


MAP_LIGHT_SLOTS = (table("lights", LightData), storage("owners", "u32"))
MAP_SLOTS = (
    table("views", LightViewData),
    texture("depth", "2d-array", "depth"),
    texture("normal", "2d-array", "unfilterable-float"),
    texture("flux", "2d-array", "unfilterable-float"),
)
_UNATTENUATED = """
fn light_arriving(layer: u32, p: vec3f) -> vec3f { return vec3f(1.0); }
"""
_ATTENUATED = """
//! use media_light
fn light_arriving(layer: u32, p: vec3f) -> vec3f {
    let owner = owners[layer];
    return media_light_transmittance(row_of_lights(owner), owner, p);
}
"""


class Inject(ComputePass):
    """Each texel of a reflective shadow map, moved along its normal, adds its lobe.

    It moves by half a cell, or up to a whole one where a flat surface is oblique to the cells and
    no wall is before it.
    """

    slots: tuple[Slot, ...] = (
        uniform("params", InjectParams),
        *MAP_SLOTS,
        *TARGET_SLOTS,
    )
    workgroup = (16, 16, 1)
    in_bands = True

    def __init__(self, gpu: Gpu, attenuation: LightAttenuation | None = None) -> None:
        """`attenuation`: media on the path from each light to the texel (Billeter2012 3.1)."""
        self._attenuation, generated = attenuation, _UNATTENUATED
        if attenuation is not None:
            self.slots = (*Inject.slots, *MAP_LIGHT_SLOTS, *attenuation.slots)
            generated = attenuation.wgsl + _ATTENUATED
        super().__init__(gpu, generated=generated)

    def encode(
        self,
        commands: Commands,
        maps: ReflectiveShadowMaps,
        target: InjectionTarget,
        lobe: Lobe,
        *,
        small: SmallObjects = EVERYTHING,
        lights: MapLights | None = None,
    ) -> None:
        """Add all texels of `maps`; `small`: which objects are left out.

        `lights` are asked for where media attenuate them.
        """
        # One invocation sums a square of texels, surface by surface, into virtual lights.
        media = {**self._attenuation.bound, **lights.bound} if self._attenuation and lights else {}
        side = -(-maps.resolution // maps.block)
        self.dispatch(
            commands,
            (side, side, maps.layers),
            params=InjectParams.of(
                resolution=maps.resolution,
                block=maps.block,
                layers=maps.layers,
                least=small.least,
                next_least=small.next_least,
                has_static=int(small.has_static),
            ),
            **map_bound(maps),
            **target.bound(lobe),
            **media,
        )


def map_bound(maps: ReflectiveShadowMaps) -> dict[str, Any]:
    """By the names of MAP_SLOTS."""
    return {"views": maps.views, "depth": maps.depth, "normal": maps.normal, "flux": maps.flux}


class ResolveParams(Struct):
    """The factor from fixed point to W sr^-1."""

    values = u32("vec4 values in the lattice")
    unit = f32("W sr^-1 per fixed-point unit")


class Resolve(ComputePass):
    """Fixed-point sums -> lattice of float4; it zeroes the sums for the next frame."""

    slots = (
        uniform("params", ResolveParams),
        storage("sums", "vec4i", "read_write"),
        storage("base", "vec4f"),
        storage("lattice", "vec4f", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "resolve.wgsl"

    def encode(
        self,
        commands: Commands,
        placement: Placement,
        sums: Buffer,
        base: Buffer,
        lattice: Buffer,
        scale: float,
    ) -> None:
        """lattice = base + sums; then clear `sums`."""
        values = 3 * placement.cells
        self.dispatch(
            commands,
            (values,),
            params=ResolveParams.of(values=values, unit=1.0 / scale),
            sums=sums,
            base=base,
            lattice=lattice,
        )


def flux_bound(lights: Iterable[Light], low: Iterable[float], high: Iterable[float]) -> float:
    """An upper bound, W, of the flux that `lights` bring into the box low..high (metres)."""
    extent = [b - a for a, b in zip(low, high, strict=True)]
    cross_section = math.pi / 4.0 * sum(e * e for e in extent)  # of the circumscribed sphere
    # Lights with extent come as samples.
    return sum(x.most_power(cross_section) for x in lights)


def fixed_point_scale(flux: float, sharpness: float = SHAPED_LOBE) -> float:
    """Units per W sr^-1 such that a cell holding all of `flux` (W) stays within 31 bits.

    `sharpness`: the largest |b| over a of the lobes that are put in.
    """
    # A power of two, so that scaling rounds nothing, with a bit to spare.
    largest = sharpness * max(flux, 1e-24) / (4.0 * math.pi)
    return float(2.0 ** (_HEADROOM_BITS - math.ceil(math.log2(largest))))


def forward_share() -> float:
    """The share of a shaped lobe that leaves through the five faces its surface leaves open."""
    # A hop's matrix: what one face gets of the constant and of the linear term.
    hop = hops("centroid")[0].matrix
    # The face ahead gets the directional part, too; the four beside it their constant one.
    constant, along = float(hop[0, 0]), float(hop[0, 1]) * SHAPED_LOBE
    return constant + along + 4.0 * constant


def new_sums(gpu: Gpu, placement: Placement) -> Buffer:
    """The fixed-point lattice, all zero."""
    return Buffer(gpu, "injected sums", 3 * placement.cells * 16)
