"""What `regions` runs: cells sorted by regions, light between regions, corrections."""

from __future__ import annotations

from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec3u
from ..gpu.slots import Slot, storage, uniform
from ..lattice.placement import LatticeSize
from ..maths.regions import OPEN, REGIONS
from .coefficients import StepCoefficients
from .propagate import StepParams

RUN = 64
"""Cells that one invocation sorts."""


class FloodParams(Struct):
    """A lattice and its regions."""

    count = vec3u("cells")
    step = u32("0: where regions begin")
    regions = vec3u("boxes along x, y, z, each of which begins one")
    has_walls = u32("whether faces may be closed")
    turn = u32("1: the second, for cells that none of the first has reached")


class SortParams(Struct):
    """How many cells there are to sort."""

    cells = u32("of the lattice")
    runs = u32("of RUN cells")


_SORT, _SIZE = uniform("params", SortParams), uniform("params", LatticeSize)
# By cell; cells by region, and where each region begins; light between regions.
_REGIONS, _MEMBERS, _STARTS = (storage(name, "u32") for name in ("regions", "members", "starts"))
_STEPPED, _SUM = storage("stepped", "vec4f"), storage("sum", "vec4f")


def _made(name: str, kind: str) -> Slot:
    return storage(name, kind, "read_write")


class _OfRegions(ComputePass):
    """Knows how many regions there are at most; a lane for each, unless it says otherwise."""

    workgroup = (REGIONS, 1, 1)

    def __init__(self, gpu: Gpu, *, constants: dict[str, float] | None = None) -> None:
        generated = f"const REGIONS = {REGIONS}u;\nconst RUN = {RUN}u;\nconst OPEN = {OPEN};"
        super().__init__(gpu, constants=constants, generated=generated)


class Seeds(_OfRegions):
    """Where a region begins in each box, and how many cells have none."""

    slots = (
        uniform("params", FloodParams),
        storage("face_visibility", "vec2u"),
        _REGIONS,
        _made("seeds", "vec2u"),
    )
    workgroup = (32, 1, 1)
    file = "region_seeds.wgsl"


class Flood(_OfRegions):
    """Which region each cell belongs to, after one more step."""

    slots = (
        uniform("params", FloodParams),
        storage("face_visibility", "vec2u"),
        storage("seeds", "vec2u"),
        storage("before", "u32"),
        _made("after", "u32"),
    )
    workgroup = (32, 4, 1)
    file = "region_flood.wgsl"


class Count(_OfRegions):
    """The cells of each region in each run."""

    slots = (_SORT, _REGIONS, _made("firsts", "u32"))
    workgroup = (32, 1, 1)
    file = "region_count.wgsl"


class Scan(_OfRegions):
    """Where in the list they begin."""

    slots = (_SORT, _made("firsts", "u32"), _made("starts", "u32"))
    file = "region_scan.wgsl"


class Sort(_OfRegions):
    """The list of cells, region by region."""

    slots = (_SORT, _REGIONS, _made("firsts", "u32"), _made("members", "u32"))
    workgroup = (32, 1, 1)
    file = "region_list.wgsl"


class Exchange(_OfRegions):
    """What regions keep of their light, and send each other."""

    slots = (
        uniform("params", StepParams),
        storage("coefficients", StepCoefficients),
        storage("medium", "vec2f"),
        storage("packs", "vec4u"),
        _REGIONS,
        _MEMBERS,
        _STARTS,
        _made("matrix", "f32"),
    )
    file = "region_exchange.wgsl"


class Invert(_OfRegions):
    """The sum over all later steps: the inverse of that matrix, less what a step has done."""

    slots = (_STARTS, _made("matrix", "f32"))
    file = "region_invert.wgsl"


class Missing(_OfRegions):
    """Power under way, by region: what a step has brought."""

    slots = (_SIZE, _MEMBERS, _STARTS, _STEPPED, _SUM, _made("missing", "f32"))
    file = "region_missing.wgsl"


class Shares(_OfRegions):
    """What later steps will bring to each cell of a region."""

    slots = (storage("matrix", "f32"), storage("missing", "f32"), _made("shares", "f32"))
    file = "region_shares.wgsl"


class Apply(_OfRegions):
    """Adds the shares to the cells."""

    slots = (_SIZE, _REGIONS, storage("shares", "f32"), _made("stepped", "vec4f"))
    workgroup = (32, 4, 2)
    file = "region_apply.wgsl"
