"""One propagation step of all cells to their six face neighbours (Kaplanyan2010 section 3.3).

propagate        the kernel: a cell an invocation, on any device and in any storage
propagate_rows   the same for CPU adapters, whose lanes share rows of cells (gpu.lanes)

Both call `stepped` of a scheme: wgsl/step6_centroid, or wgsl/step6_paper, the step as printed.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES, has_row_lanes
from ..gpu.layout import Struct, f32, u32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import Slot, storage, uniform
from ..maths.lattice6 import SPREAD_KEPT, Scheme, hops
from .storage import FLOAT, Format

CHANNELS = 3
_MARCHED_CELLS = 8192
"""Cells of the layers that propagate_rows marches: 8 layers of 32 x 32, 2 of 64 x 64 (measured)."""
_PAIR = "vec4<u64>"


class StepParams(Struct):
    """The lattice's size, and what the step does."""

    count = vec3u("cells")
    handed_back = f32("share of negative power into closed faces that is handed back")
    layers = u32("that an invocation of propagate_rows marches")


def _slots(element: str, face: str) -> tuple[Slot, ...]:
    return (
        uniform("params", StepParams),
        storage("before", element),
        storage("after", element, "read_write"),
        storage("faces", face),
        storage("added", element),
    )


@dataclass(frozen=True)
class StepKind:
    """What a step does beside handing light on.

    `is_blocked`: faces stop their share; `is_reflecting`: it bounces into its own cell; `is_added`:
    a lattice is added to what the step makes; `kept`: of the spread of directions in a hop
    (`maths.lattice6.spread_kept`).
    """

    scheme: Scheme = "centroid"
    is_blocked: bool = False
    is_reflecting: bool = False
    is_added: bool = False
    kept: float = SPREAD_KEPT

    @property
    def wgsl(self) -> str:
        """The scheme's `stepped`."""
        return f"//! use step6_{self.scheme}\n"

    @property
    def constants(self) -> dict[str, float]:
        """The shader's overrides."""
        is_centroid = self.scheme == "centroid"

        # Overrides of the shader, so that a step without blockers has no code for them.
        return (hop_constants(self.kept) if is_centroid else {}) | {
            "IS_BLOCKED": float(self.is_blocked),
            "IS_REFLECTING": float(self.is_reflecting),
            "IS_ADDED": float(self.is_added),
        }


class _PropagateCells(ComputePass):
    """A cell an invocation."""

    file = "propagate.wgsl"

    def __init__(self, gpu: Gpu, kind: StepKind, format: Format) -> None:
        self.slots = _slots(format.element, "vec4u")
        super().__init__(gpu, constants=kind.constants, generated=format.wgsl + kind.wgsl)


class _PropagateRows(ComputePass):
    """A pair of cells a lane, marched over some layers."""

    slots = _slots(_PAIR, _PAIR)
    workgroup = (LANES, 1, 1)
    file = "propagate_rows.wgsl"

    def __init__(self, gpu: Gpu, kind: StepKind) -> None:
        super().__init__(gpu, constants=kind.constants, generated=kind.wgsl)


class Step:
    """after = M before + added, for a lattice of `count` (x, y, z) cells stored in a format."""

    def __init__(
        self, gpu: Gpu, count: tuple[int, int, int], kind: StepKind, format: Format = FLOAT
    ) -> None:
        self._count, self._layers = count, 1
        if takes_rows(gpu, count, format):
            # Longer columns reload less at their ends, shorter ones are more work for all cores.
            x, y, z = count
            self._layers = max(2, _MARCHED_CELLS // (x * y))
            self._invocations = (x // 2, y, -(-z // self._layers))
            self._pass: ComputePass = _PropagateRows(gpu, kind)
        else:
            self._invocations = count
            self._pass = _PropagateCells(gpu, kind, format)

    def encode(
        self,
        commands: Commands,
        before: Buffer,
        after: Buffer,
        faces: Buffer,
        handed_back: float = 1.0,
        added: Buffer | None = None,
    ) -> None:
        """`handed_back`: what closed faces hand back of wrong-signed power."""
        self._pass.dispatch(
            commands,
            self._invocations,
            params=StepParams.of(count=self._count, handed_back=handed_back, layers=self._layers),
            before=before,
            after=after,
            faces=faces,
            added=added or before,
        )


def takes_rows(gpu: Gpu, count: tuple[int, int, int], format: Format) -> bool:
    """Whether a lattice of `count` cells is propagated in rows of lanes."""
    return count[0] % 2 == 0 and format is FLOAT and has_row_lanes(gpu)


def hop_constants(kept: float = SPREAD_KEPT) -> dict[str, float]:
    """The overrides of wgsl/hops6.wgsl; `kept` as in `maths.lattice6.spread_kept`."""
    matrix = hops("centroid", kept)[0].matrix
    return {
        "MEAN_TO_MEAN": float(matrix[0, 0]),
        "FLUX_TO_MEAN": float(matrix[0, 1]),
        "MEAN_TO_FLUX": float(matrix[1, 0]),
        "FLUX_ALONG": float(matrix[1, 1]),
        "FLUX_ACROSS": float(matrix[2, 2]),
    }
