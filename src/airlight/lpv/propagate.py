"""Propagate light between the six face neighbours of every cell (Kaplanyan2010 section 3.3).

What surfaces need is the sum of all steps, B_n = s + M s + ... + M^(n-1) s, s the state after the
first. A step costs what it reads and writes, so the sum is made by doubling: B_2k = B_k + M^k B_k
takes as many steps as adding state after state, but only one addition per doubling.
differs: Kaplanyan2010 accumulates after every step, and ignores blockers in the first; ours block
from the first (lattice.inject shapes lobes for it).

The paper's scheme clamps negative intensities, so it is not linear in the state; there every
state is accumulated, the first step free, as the paper says.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import Placement
from ..maths.lattice6 import Hop, Scheme, hops
from .columns import column_march

CHANNELS = 3
_CPU_TILE, _CPU_SLAB = (2, 4), 8  # measured best: wider tiles load less but take long to compile


class StepParams(Struct):
    """The lattice's size, and what the step does."""

    count = vec3u("cells")
    kept = f32("share of negative power into closed faces that is handed back")


class _Step(ComputePass):
    """One step of all three channels, in columns marched along z (lpv.columns)."""

    slots = (
        uniform("params", StepParams),
        storage("before", "vec4f"),
        storage("after", "vec4f", "read_write"),
        storage("faces", "vec4u"),
    )
    workgroup = (16, 8, 1)
    file = "propagate.wgsl"


class AccumulateParams(Struct):
    """The lattice's size."""

    values = u32("vec4 values in the lattice")


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
        nx, ny, _ = placement.count
        self._tile = (min(_CPU_TILE[0], nx), min(_CPU_TILE[1], ny)) if gpu.is_cpu else (1, 1)
        self._slab = _CPU_SLAB if gpu.is_cpu else 1
        text = pair_functions(scheme) + column_march(*self._tile, self._slab)

        def step(blocked: bool) -> _Step:
            flags = {"IS_BLOCKED": blocked, "IS_REFLECTING": blocked and is_reflecting}
            return _Step(gpu, generated=text, constants={k: int(v) for k, v in flags.items()})

        self._later = step(is_blocked)
        # The paper's first step ignores blockers.
        self._first = step(False) if is_blocked and scheme == "paper" else self._later
        self._bytes = CHANNELS * placement.cells * 16
        names = ("first state", "propagated light", "propagation ping", "propagation pong")
        self._lattices = [Buffer(gpu, name, self._bytes) for name in names]
        self._accumulate = _Accumulate(gpu)

    def encode(
        self, commands: Commands, injected: Buffer, faces: Buffer, iterations: int
    ) -> Buffer:
        """The sum of the states after 1 to `iterations` steps from `injected`, without itself."""
        first, total, ping, pong = self._lattices
        if iterations < 1:
            commands.encoder.clear_buffer(total.handle)
            return total
        # Shaped lobes are negative behind their surface, which their power is scaled for: what
        # they would send there is dropped (lattice.inject).
        self._step(commands, self._first, injected, first, faces, kept=0.0)
        commands.encoder.copy_buffer_to_buffer(first.handle, 0, total.handle, 0, self._bytes)
        if self.scheme == "paper":
            return self._accumulated(commands, faces, iterations - 1)
        steps = 1
        for bit in f"{iterations:b}"[1:]:
            state = self._stepped(commands, total, (ping, pong), faces, steps)
            self._add(commands, state, total)
            steps *= 2
            if bit == "1":
                self._step(commands, self._later, total, ping, faces)
                self._add(commands, first, ping)
                total, ping = ping, total
                steps += 1
        return total

    def _accumulated(self, commands: Commands, faces: Buffer, steps: int) -> Buffer:
        """Every one of `steps` more states added to the first."""
        first, total, ping, pong = self._lattices
        state = first
        for _ in range(steps):
            target = pong if state is ping else ping
            self._step(commands, self._later, state, target, faces)
            self._add(commands, target, total)
            state = target
        return total

    def _stepped(
        self, commands: Commands, state: Buffer, spare: tuple[Buffer, Buffer], faces: Buffer,
        steps: int,
    ) -> Buffer:  # fmt: skip
        """What `state` has become after `steps` steps, in one of the `spare` lattices."""
        for index in range(steps):
            self._step(commands, self._later, state, spare[index % 2], faces)
            state = spare[index % 2]
        return state

    def _add(self, commands: Commands, state: Buffer, total: Buffer) -> None:
        values = CHANNELS * self.placement.cells
        self._accumulate.dispatch(
            commands, (values,), params=AccumulateParams(values=values), state=state, total=total
        )

    def _step(
        self, commands: Commands, step: _Step, before: Buffer, after: Buffer, faces: Buffer,
        kept: float = 1.0,
    ) -> None:  # fmt: skip
        nx, ny, nz = self.placement.count
        columns = (-(-nx // self._tile[0]), -(-ny // self._tile[1]), -(-nz // self._slab))
        step.dispatch(
            commands, columns, params=StepParams(count=self.placement.count, kept=kept),
            before=before, after=after, faces=faces,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        for lattice in self._lattices:
            lattice.release()


def pair_functions(scheme: Scheme) -> str:
    """WGSL of `along_x`, `along_y`, `along_z`: what two opposite neighbours' light adds.

    Their first argument travels up the axis, the second down. Weights are literals: the software
    driver reads a table ten times slower.
    """
    matrix = hops(scheme)[0].matrix
    shares = "".join(
        f"const {name} = {_literal(value)};\n"
        for name, value in (("HOP_EVEN", matrix[0, 0]), ("HOP_DIRECT", matrix[0, 1]))
    )
    if scheme == "paper":
        pairs = [
            f"fn along_{axis}(up: vec4f, down: vec4f) -> vec4f {{ "
            f"return hop_{2 * k}(up) + hop_{2 * k + 1}(down); }}"
            for k, axis in enumerate("xyz")
        ]
        return shares + hop_functions(scheme) + "\n" + "\n".join(pairs) + "\n"
    return shares + "\n".join(_linear_pair(k, axis) for k, axis in enumerate("xyz")) + "\n"


def _linear_pair(index: int, axis: str) -> str:
    """Opposite hops differ in the sign of what couples a with b along the axis."""
    matrix, b = hops("centroid")[2 * index].matrix, index + 1
    same = ", ".join(_literal(matrix[k, k]) for k in range(4))
    crossed = ["0.0"] * 4
    crossed[0] = f"odd.{'xyzw'[b]} * {_literal(matrix[0, b])}"
    crossed[b] = f"odd.x * {_literal(matrix[b, 0])}"
    return (
        f"fn along_{axis}(up: vec4f, down: vec4f) -> vec4f {{\n    let odd = up - down;\n"
        f"    return (up + down) * vec4f({same}) + vec4f({', '.join(crossed)});\n}}"
    )


def hop_functions(scheme: Scheme) -> str:
    """WGSL of `hop_0` .. `hop_5` (+x -x +y -y +z -z): what a neighbour's light adds."""
    text = _clamped_hop if scheme == "paper" else _linear_hop
    return "\n".join(text(index, hop) for index, hop in enumerate(hops(scheme)))


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
