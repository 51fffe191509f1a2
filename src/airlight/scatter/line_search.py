"""How much of a coarse lattice's correction to take: the line search of a minimal-residual method.

With r = I + M Q - Q and the correction e, Q + t e leaves r - t (e - M e); t minimises its square.
Walls that a coarse lattice cannot hold make e too long or wrong: t is then small, and no cycle
makes the residual grow. Another smoothing step of Q + t e costs nothing more: (I + M Q) + t M e.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeSize
from .coefficients import CHANNELS
from .level import Level

_PARTS = 512  # partial sums of a channel
_SAFE, _BOLD = 1.8, 4.0  # on the finest lattice, which decides; and on others


class SearchParams(Struct):
    """Two lattices, one half as fine as the other."""

    fine = vec3u("cells")
    coarse = vec3u("cells")


class LengthParams(Struct):
    """What is asked of a length."""

    most = f32("of the length that leaves the least residual; beyond 2 it grows")


class _Sum(ComputePass):
    slots = (
        uniform("params", SearchParams),
        storage("stepped", "vec4f"),
        storage("sum", "vec4f"),
        storage("change", "vec4f"),
        storage("answer", "vec4f"),
        storage("parts", "vec2f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "line_search_sum.wgsl"


class _Length(ComputePass):
    slots = (
        uniform("params", LengthParams),
        storage("parts", "vec2f"),
        storage("lengths", "f32", "read_write"),
    )
    workgroup = (4, 1, 1)
    file = "line_search_length.wgsl"


class _Apply(ComputePass):
    slots = (
        uniform("params", LatticeSize),
        storage("stepped", "vec4f"),
        storage("answer", "vec4f"),
        storage("lengths", "f32"),
        storage("corrected", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "line_search_apply.wgsl"


class LineSearch:
    """Finds the length of a correction per channel, and takes the corrected sum one step on."""

    def __init__(self, gpu: Gpu) -> None:
        parts = f"const PARTS = {_PARTS}u;"
        # Partial sums first, then their sum, so that their order is always the same.
        self._sum, self._length = _Sum(gpu, generated=parts), _Length(gpu, generated=parts)
        self._apply = _Apply(gpu)
        self._parts = Buffer(gpu, "partial sums", CHANNELS * _PARTS * 8)
        self._lengths = Buffer(gpu, "correction lengths", CHANNELS * 4)

    def encode(
        self,
        commands: Commands,
        level: Level,
        coarse: Level,
        *,
        current: Buffer,
        stepped: Buffer,
        corrected: Buffer,
    ) -> None:
        """corrected = stepped + t M e, where `stepped` = I + M current.

        `level.track` holds the correction e, `level.answer` M e.
        """
        # Sums of r.d and d.d over the cells of the coarser lattice, d = e - M e.
        self._sum.dispatch(
            commands,
            (_PARTS, CHANNELS),
            params=SearchParams.of(fine=level.count, coarse=coarse.count),
            stepped=stepped,
            sum=current,
            change=level.track,
            answer=level.answer,
            parts=self._parts,
        )
        # The step t that leaves the least residual, r.d / d.d, within what is safe.
        self._length.dispatch(
            commands,
            (CHANNELS,),
            params=LengthParams.of(most=_SAFE if level.is_finest else _BOLD),
            parts=self._parts,
            lengths=self._lengths,
        )
        # One step of the corrected sum, from the steps of both its parts.
        self._apply.dispatch(
            commands,
            level.grid,
            params=LatticeSize.of(count=level.count),
            stepped=stepped,
            answer=level.answer,
            lengths=self._lengths,
            corrected=corrected,
        )
