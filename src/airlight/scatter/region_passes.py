"""What `regions` runs: cells sorted by regions, light between regions, corrections."""

from __future__ import annotations

from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec3u
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeSize
from ..maths.regions import OPEN, REGIONS
from .coefficients import StepCoefficients
from .propagate import StepParams

RUN = 64
"""Cells that one invocation sorts."""


class FloodParams(Struct):
    """A lattice and its regions."""

    count = vec3u("cells")
    step = u32("0: begin with the regions' middles")
    regions = vec3u("along x, y, z")
    has_walls = u32("whether faces may be closed")


class SortParams(Struct):
    """How many cells there are to sort."""

    cells = u32("of the lattice")
    runs = u32("of RUN cells")


class Flood(ComputePass):
    """Which region each cell belongs to, after one more step."""

    slots = (
        uniform("params", FloodParams),
        storage("face_visibility", "vec2u"),
        storage("before", "u32"),
        storage("after", "u32", "read_write"),
    )
    workgroup = (32, 4, 1)
    file = "region_flood.wgsl"

    def __init__(self, gpu: Gpu) -> None:
        super().__init__(gpu, generated=f"const OPEN = {OPEN};")


class _OfRegions(ComputePass):
    """Knows how many regions there are at most."""

    def __init__(self, gpu: Gpu, *, constants: dict[str, float] | None = None) -> None:
        generated = f"const REGIONS = {REGIONS}u;\nconst RUN = {RUN}u;"
        super().__init__(gpu, constants=constants, generated=generated)


class Count(_OfRegions):
    """The cells of each region in each run."""

    slots = (
        uniform("params", SortParams),
        storage("regions", "u32"),
        storage("firsts", "u32", "read_write"),
    )
    workgroup = (32, 1, 1)
    file = "region_count.wgsl"


class Scan(_OfRegions):
    """Where in the list they begin."""

    slots = (
        uniform("params", SortParams),
        storage("firsts", "u32", "read_write"),
        storage("starts", "u32", "read_write"),
    )
    workgroup = (REGIONS, 1, 1)
    file = "region_scan.wgsl"


class Sort(_OfRegions):
    """The list of cells, region by region."""

    slots = (
        uniform("params", SortParams),
        storage("regions", "u32"),
        storage("firsts", "u32", "read_write"),
        storage("members", "u32", "read_write"),
    )
    workgroup = (32, 1, 1)
    file = "region_list.wgsl"


class Exchange(_OfRegions):
    """What regions keep of their light, and send each other."""

    slots = (
        uniform("params", StepParams),
        storage("coefficients", StepCoefficients),
        storage("medium", "vec2f"),
        storage("packs", "vec4u"),
        storage("regions", "u32"),
        storage("members", "u32"),
        storage("starts", "u32"),
        storage("matrix", "f32", "read_write"),
    )
    workgroup = (REGIONS, 1, 1)
    file = "region_exchange.wgsl"


class Invert(_OfRegions):
    """What all of it comes to in the end."""

    slots = (storage("starts", "u32"), storage("matrix", "f32", "read_write"))
    workgroup = (REGIONS, 1, 1)
    file = "region_invert.wgsl"


class Missing(_OfRegions):
    """Light under way, region by region."""

    slots = (
        uniform("params", LatticeSize),
        storage("members", "u32"),
        storage("starts", "u32"),
        storage("stepped", "vec4f"),
        storage("sum", "vec4f"),
        storage("missing", "f32", "read_write"),
    )
    workgroup = (REGIONS, 1, 1)
    file = "region_missing.wgsl"


class Shares(_OfRegions):
    """What comes of it for each cell of a region."""

    slots = (
        storage("matrix", "f32"),
        storage("missing", "f32"),
        storage("shares", "f32", "read_write"),
    )
    workgroup = (REGIONS, 1, 1)
    file = "region_shares.wgsl"


class Apply(_OfRegions):
    """That, added to the cells."""

    slots = (
        uniform("params", LatticeSize),
        storage("regions", "u32"),
        storage("shares", "f32"),
        storage("stepped", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "region_apply.wgsl"
