"""Propagate light between the six face neighbours of every cell (Kaplanyan2010 section 3.3).

What surfaces need is the sum of all steps, A_n = I_0 + I_1 + ... + I_n with I_k+1 = M I_k. The
step is linear, so the sum itself can be propagated: with B_1 = M I_0 and
B_k+1 = B_1 + M B_k, A_n = I_0 + B_n: a step reads the sum, adds the source, and no second
lattice is kept.
differs: Kaplanyan2010 propagates the state and accumulates it into a second lattice, and ignores
blockers in the first step; ours block from the first (lattice.inject shapes lobes for it).

The paper's scheme clamps negative intensities, so it is not linear in the state; there the state
is propagated and accumulated, the first step free, as the paper says.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import Placement
from ..maths.lattice6 import Hop, Scheme, hops

CHANNELS = 3
_TILE = 2
_SLAB = 8  # layers that one invocation marches through


class StepParams(Struct):
    """The lattice's size and how it is cut into columns."""

    count = vec3u("cells")
    slabs = u32("slabs of _SLAB layers along z")


class _Step(ComputePass):
    """One step in columns of 2 x 2 cells marched along z: three loads a cell instead of six."""

    slots = (
        uniform("params", StepParams),
        storage("before", "vec4f"),
        storage("source", "vec4f"),
        storage("after", "vec4f", "read_write"),
        storage("faces", "vec4u"),
    )
    workgroup = (8, 8, 4)
    file = "propagate.wgsl"


class AccumulateParams(Struct):
    """The lattice's size."""

    values = u32("vec4 values in the lattice")
    is_first = u32("1: start the sum anew")


class _Accumulate(ComputePass):
    slots = (
        uniform("params", AccumulateParams),
        storage("state", "vec4f"),
        storage("total", "vec4f", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "accumulate.wgsl"


class Propagate:
    """Iterates steps between lattices of its own.

    `scheme` is "centroid" or "paper"; with `is_blocked` each hop loses its blocked share, and
    with `is_reflecting` that share bounces into its own cell (Kaplanyan2010 section 7), coloured
    by the face's reflectance.
    differs: the paper injects the bounce one cell further, beyond the blocker's plane.
    """

    def __init__(
        self,
        gpu: Gpu,
        placement: Placement,
        scheme: Scheme = "centroid",
        *,
        is_blocked: bool,
        is_reflecting: bool = False,
    ) -> None:
        self.scheme, self.placement = scheme, placement
        text = hop_functions(scheme)

        def step(blocked: bool, first: bool) -> _Step:
            flags = {"IS_BLOCKED": blocked, "IS_REFLECTING": blocked and is_reflecting,
                     "IS_FIRST": first}  # fmt: skip
            return _Step(gpu, generated=text, constants={k: int(v) for k, v in flags.items()})

        # The paper's first step ignores blockers; ours drops what shaped lobes send backwards.
        self._first = step(is_blocked and scheme != "paper", True)
        self._later = step(is_blocked, False)
        nbytes = CHANNELS * placement.cells * 16
        self._lattices = [Buffer(gpu, f"propagation {k}", nbytes) for k in range(3)]
        self._zero = Buffer(gpu, "no light", nbytes)
        self._accumulate = _Accumulate(gpu)

    def encode(
        self, commands: Commands, injected: Buffer, faces: Buffer, iterations: int
    ) -> Buffer:
        """The sum of the states after 1 to `iterations` steps from `injected`, without itself."""
        if iterations < 1:
            return self._zero
        if self.scheme == "paper":
            return self._encode_states(commands, injected, faces, iterations)
        first, ping, pong = self._lattices
        self._step(commands, self._first, injected, self._zero, first, faces)
        total = first
        for _ in range(1, iterations):
            target = pong if total is ping else ping
            self._step(commands, self._later, total, first, target, faces)
            total = target
        return total

    def _encode_states(
        self, commands: Commands, injected: Buffer, faces: Buffer, iterations: int
    ) -> Buffer:
        total, ping, pong = self._lattices
        values = CHANNELS * self.placement.cells
        state = injected
        for index in range(iterations):
            target = pong if state is ping else ping
            step = self._later if index else self._first
            self._step(commands, step, state, self._zero, target, faces)
            self._accumulate.dispatch(
                commands, (values,), state=target, total=total,
                params=AccumulateParams(values=values, is_first=int(index == 0)),
            )  # fmt: skip
            state = target
        return total

    def _step(
        self, commands: Commands, step: _Step, before: Buffer, source: Buffer, after: Buffer,
        faces: Buffer,
    ) -> None:  # fmt: skip
        nx, ny, nz = self.placement.count
        slabs = -(-nz // _SLAB)
        step.dispatch(
            commands, (-(-nx // _TILE), -(-ny // _TILE), CHANNELS * slabs),
            params=StepParams(count=self.placement.count, slabs=slabs),
            before=before, source=source, after=after, faces=faces,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        for lattice in (*self._lattices, self._zero):
            lattice.release()


def hop_functions(scheme: Scheme) -> str:
    """WGSL of `hop_0` .. `hop_5` (+x -x +y -y +z -z): what a neighbour's light adds.

    Weights are literals: the software driver reads a table ten times slower.
    """
    is_clamped = scheme == "paper"
    text = _clamped_hop if is_clamped else _linear_hop
    even, direct = hops(scheme)[0].matrix[0, :2]
    shares = f"const HOP_EVEN = {_literal(even)};\nconst HOP_DIRECT = {_literal(direct)};\n"
    return shares + "\n".join(text(index, hop) for index, hop in enumerate(hops(scheme)))


def _linear_hop(index: int, hop: Hop) -> str:
    rows = [_weighted(row) for row in hop.matrix]
    return f"fn hop_{index}(v: vec4f) -> vec4f {{ return vec4f({', '.join(rows)}); }}"


def _clamped_hop(index: int, hop: Hop) -> str:
    lines = [f"fn hop_{index}(v: vec4f) -> vec4f {{", "    var gained = vec4f(0.0);"]
    for face in hop.faces:
        along = _weighted([1.0, *face.receive])
        gain = ", ".join(_literal(g) for g in (1.0 / (4.0 * 3.141592653589793), *face.emit))
        power = f"{_literal(face.solid_angle_sr)} * max(0.0, {along})"
        lines.append(f"    gained += {power} * vec4f({gain});")
    return "\n".join([*lines, "    return gained;", "}"])


def _weighted(weights: Any) -> str:
    terms = [
        f"{_literal(w)} * v.{c}" for w, c in zip(weights, "xyzw", strict=True) if abs(w) > 1e-12
    ]
    return " + ".join(terms) or "0.0"


def _literal(value: float) -> str:
    return f"{value:.9e}".replace("e+00", "")
