"""Visibility of all 26 hops of every cell, packed once for as long as the geometry stands.

maths.lattice26_walls.open_hops is the NumPy twin.
differs: Billeter2012 section 4.2 renders six shadow maps for it in every frame.
"""

from __future__ import annotations

from itertools import permutations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .hop_wgsl import COUNT, offsets, opposite

PACKS = 4
"""vec4u per cell: two of incoming hops by the neighbour they come from, two of outgoing hops; the
last word of the fourth is the walls' reflectance, rgb unorm8."""


class WallParams(Struct):
    """The lattice's size."""

    count = vec3u("cells")


class _Outgoing(ComputePass):
    slots = (
        uniform("params", WallParams),
        storage("face_visibility", "vec2u"),
        storage("reflectance", "u32"),
        storage("packs", "vec4u", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "walls_outgoing.wgsl"


class _Incoming(ComputePass):
    slots = (
        uniform("params", WallParams),
        storage("packs", "vec4u", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "walls_incoming.wgsl"


class CellReflectance(ComputePass):
    """Mean colour of the walls in and around each cell, rgb unorm8 in a u32."""

    slots = (
        uniform("params", WallParams),
        storage("faces", "vec4u"),
        storage("reflectance", "u32", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "walls_reflectance.wgsl"

    def encode(
        self, commands: Commands, count: tuple[int, int, int], faces: Buffer, reflectance: Buffer
    ) -> None:
        """`faces` as lattice.blockers.Blockers.faces."""
        self.dispatch(
            commands, count, params=WallParams(count=count), faces=faces, reflectance=reflectance
        )


class Walls:
    """Makes `packs` (4 vec4u per cell) of a lattice from the visibility of its faces."""

    def __init__(self, gpu: Gpu) -> None:
        self._outgoing = _Outgoing(gpu, generated=_path_functions())
        self._incoming = _Incoming(gpu, generated=_transposition())

    def encode(
        self,
        commands: Commands,
        count: tuple[int, int, int],
        face_visibility: Buffer,
        reflectance: Buffer,
        packs: Buffer,
    ) -> None:
        """`face_visibility` as lattice.blockers; `reflectance` one u32 (rgb unorm8) per cell."""
        params = WallParams(count=count)
        self._outgoing.dispatch(
            commands,
            count,
            params=params,
            face_visibility=face_visibility,
            reflectance=reflectance,
            packs=packs,
        )
        self._incoming.dispatch(commands, count, params=params, packs=packs)


def new_packs(gpu: Gpu, cells: int) -> Buffer:
    """Memory for `Walls.encode`."""
    return Buffer(gpu, "visibility of 26 hops", cells * PACKS * 16)


def _path_functions() -> str:
    """`path_j(at)`: the mean over face-by-face paths of the product of visibility."""
    return "\n".join(_path_function(j) for j in range(COUNT))


def _path_function(j: int) -> str:
    offset = offsets()[j]
    axes = [axis for axis in range(3) if offset[axis]]
    paths = list(permutations(axes))
    products = " + ".join(_path_product(offset, order) for order in paths)
    return f"fn path_{j}(at: vec3i) -> f32 {{ return ({products}) / {len(paths):.1f}; }}"


def _path_product(offset: tuple[int, int, int], order: tuple[int, ...]) -> str:
    at, parts = [0, 0, 0], []
    for axis in order:
        # Visibility belongs to the cell that a hop enters.
        at[axis] += offset[axis]
        face = 2 * axis + (0 if offset[axis] > 0 else 1)
        parts.append(f"entered(at + vec3i({at[0]}, {at[1]}, {at[2]}), {face}u)")
    return " * ".join(parts)


def _transposition() -> str:
    """`incoming_word_k(at)`: visibility of the hops that arrive from four neighbours."""
    words = []
    for word in range(-(-COUNT // 4)):
        parts = []
        for j in range(4 * word, min(4 * word + 4, COUNT)):
            x, y, z = offsets()[j]
            parts.append(f"outgoing(at + vec3i({x}, {y}, {z}), {opposite(j)}u)")
        parts += ["1.0"] * (4 - len(parts))
        words.append(
            f"fn incoming_word_{word}(at: vec3i) -> u32 {{\n"
            f"    return pack4x8unorm(vec4f({', '.join(parts)}));\n}}"
        )
    return "\n".join(words)
