"""A coarse lattice's correction, as long as leaves the least residual, taken one step on.

With r = I + M Q - Q and the correction e, Q + t e leaves r - t (e - M e); t minimises its square.
Walls that a coarse lattice cannot hold make e too long or wrong: t is then small, and no cycle
makes the residual grow. Another smoothing step of Q + t e costs nothing more: (I + M Q) + t M e.
Source: the one step of a minimal-residual method along e.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS
from .propagate import Count

_PARTS = 512  # partial sums of a channel
_SAFE, BOLD = 1.8, 4.0  # on the finest lattice, which decides; and on others


class SearchParams(Struct):
    """Two lattices, one half as fine as the other."""

    fine = vec3u("cells")
    coarse = vec3u("cells")


class LengthParams(Struct):
    """What is asked of a length."""

    most = f32("of the length that leaves the least residual; beyond 2 it grows")


class CorrectParams(Struct):
    """The lattice's size."""

    count = vec3u("cells")


class _Search(ComputePass):
    slots = (
        uniform("params", SearchParams),
        storage("stepped", "vec4f"),
        storage("sum", "vec4f"),
        storage("change", "vec4f"),
        storage("answer", "vec4f"),
        storage("parts", "vec2f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "level_search.wgsl"


class _Length(ComputePass):
    slots = (
        uniform("params", LengthParams),
        storage("parts", "vec2f"),
        storage("lengths", "f32", "read_write"),
    )
    workgroup = (4, 1, 1)
    file = "level_length.wgsl"


class _Correct(ComputePass):
    slots = (
        uniform("params", CorrectParams),
        storage("stepped", "vec4f"),
        storage("answer", "vec4f"),
        storage("lengths", "f32"),
        storage("corrected", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "level_correct.wgsl"


class Correction:
    """Finds the length per channel and takes the corrected sum one step on."""

    def __init__(self, gpu: Gpu) -> None:
        parts = f"const PARTS = {_PARTS}u;"
        self._search, self._length = _Search(gpu, generated=parts), _Length(gpu, generated=parts)
        self._correct = _Correct(gpu)
        self._parts = Buffer(gpu, "partial sums", CHANNELS * _PARTS * 8)
        self._lengths = Buffer(gpu, "correction lengths", CHANNELS * 4)

    def encode(
        self,
        commands: Commands,
        count: Count,
        coarse: Count,
        *,
        current: Buffer,
        stepped: Buffer,
        change: Buffer,
        answer: Buffer,
        corrected: Buffer,
        is_finest: bool,
    ) -> None:
        """corrected = stepped + t answer; `stepped` = I + M current, `answer` = M change."""
        nx, ny, nz = count
        self._search.dispatch(
            commands,
            (_PARTS, CHANNELS),
            params=SearchParams.of(fine=count, coarse=coarse),
            stepped=stepped,
            sum=current,
            change=change,
            answer=answer,
            parts=self._parts,
        )
        self._length.dispatch(
            commands,
            (CHANNELS,),
            params=LengthParams.of(most=_SAFE if is_finest else BOLD),
            parts=self._parts,
            lengths=self._lengths,
        )
        self._correct.dispatch(
            commands,
            (nx, ny, CHANNELS * nz),
            params=CorrectParams.of(count=count),
            stepped=stepped,
            answer=answer,
            lengths=self._lengths,
            corrected=corrected,
        )
