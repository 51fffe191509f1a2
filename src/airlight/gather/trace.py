"""Rays from gather points, and the surfaces that they meet."""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import image, storage, texture, uniform
from ..rays.rays import RAY_SLOTS, RayScene
from ..surface.hits import Hits
from .albedo import AlbedoData, Albedos
from .cells import CellPoints
from .guide import LightPatch
from .points import Points

AnyPoints = Points | CellPoints
"""What paths start from."""


class TraceParams(Struct):
    """How many points and rays there are, and the number of the first ray of each."""

    reduced = vec2u("points")
    rays = u32("of a point")
    first_ray = u32()
    segment = u32("of the paths; 0 starts at points")
    raised = f32("m, how far above their surface later segments start")
    pad = vec2u()


@dataclass(frozen=True)
class Segment:
    """A segment of paths: the numbers of their rays, its own, and how far above surfaces, m, it
    starts.

    `counts`: for how many of these paths each of those stands that go on from where it ends.
    """

    numbers: range
    index: int
    raised: float
    counts: float = 1.0


class _Trace(ComputePass):
    slots = (
        uniform("params", TraceParams),
        texture("starts", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        *RAY_SLOTS,
        storage("albedo_rows", AlbedoData),
        storage("albedo_texels", "u32"),
        image("hit_positions", "rgba32float"),
        image("hit_normals", "rgba16float"),
        image("hit_albedos", "rgba16float"),
    )
    workgroup = (8, 8, 1)
    in_bands = True
    file = "trace.wgsl"


class _Bounce(_Trace):
    slots = (
        *_Trace.slots,
        storage("lit_patches", LightPatch),
        storage("paths", "vec4f", "read_write"),
    )
    file = "bounce.wgsl"


class _Guided(_Trace):
    slots = (*_Trace.slots, storage("lit_patches", LightPatch))
    file = "guided.wgsl"


class _FromAir(_Trace):
    slots = (*_Trace.slots, storage("lit_patches", LightPatch))
    file = "from_air.wgsl"


class Trace:
    """Traces batches of rays through a scene whose materials reflect as `albedos` say."""

    def __init__(self, gpu: Gpu, scene: RayScene, albedos: Albedos) -> None:
        self._scene, self._albedos = scene, albedos
        self.constants = scene.constants
        # A kernel for each start: points, hits, cells of media, points towards patches.
        self._first = _Trace(gpu, constants=scene.constants)
        self._next = _Bounce(gpu, constants=scene.constants)
        self._from_air = _FromAir(gpu, constants=scene.constants | {"FROM_AIR": 1.0})
        self._guided = _Guided(gpu, constants=scene.constants)

    def encode(
        self,
        commands: Commands,
        points: AnyPoints,
        pair: tuple[Hits, Hits],
        segment: Segment,
        guide: tuple[Buffer, Buffer],
    ) -> None:
        """Write what rays meet to the second of `pair`.

        Those of the first segment start at the points, later ones where the first of `pair` ended.
        `guide`: the patches that lead some of the later ones, and the paths, of which each is
        scaled by what it then counts.
        """
        before, hits = pair
        is_first = segment.index == 0
        # First segments start at points or cells, later ones where the last one met a surface.
        first = self._from_air if isinstance(points, CellPoints) else self._first
        used = first if is_first else self._next
        start = points if is_first else before
        lit_patches, paths = guide
        more = {} if used is self._first else {"lit_patches": lit_patches}
        more |= {} if is_first else {"paths": paths}
        self._dispatch(commands, used, points, _start(start), hits, segment, more)

    def encode_guided(
        self, commands: Commands, points: Points, hits: Hits, segment: Segment, patches: Buffer
    ) -> None:
        """Write what rays from points towards lit `patches` meet to `hits`."""
        more = {"lit_patches": patches}
        self._dispatch(commands, self._guided, points, _start(points), hits, segment, more)

    def _dispatch(
        self,
        commands: Commands,
        used: ComputePass,
        points: AnyPoints,
        start: dict[str, Texture],
        hits: Hits,
        segment: Segment,
        more: dict[str, Buffer],
    ) -> None:
        # The rays of a batch lie one below the other: a row of points for each number.
        used.dispatch(
            commands,
            (points.reduced[0], points.reduced[1] * len(segment.numbers)),
            params=TraceParams(
                reduced=points.reduced,
                rays=len(segment.numbers),
                first_ray=segment.numbers.start,
                segment=segment.index,
                raised=segment.raised,
                pad=(0, 0),
            ),
            **start,
            **self._scene.bound,
            **self._albedos.bound,
            **more,
            hit_positions=hits.positions,
            hit_normals=hits.normal,
            hit_albedos=hits.albedo,
        )


def _start(of: AnyPoints | Hits) -> dict[str, Texture]:
    """Where rays start, and the normals there."""
    if isinstance(of, Hits):
        return {"starts": of.positions, "normals": of.normal}
    return {"starts": of.starts, "normals": of.normals}
