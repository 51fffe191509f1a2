"""Propagate light between the six face neighbours of every cell (Kaplanyan2010 section 3.3).

What surfaces need is the sum of all steps, s + M s + M^2 s + ..., s the state after the first. A
step costs what it reads and writes, so states are not added one by one: eight are summed by
doubling, S = (1 + M^4)(1 + M^2)(1 + M) s, and then M^8 S, M^16 S ... are added. The last step of a
doubling adds what it finds, so that doubling costs no passes of its own.
differs: Kaplanyan2010 accumulates after every step, and ignores blockers in the first; ours block
from the first (lattice.inject shapes lobes for it).

The tail: late states have the shape of the slowest mode and shrink by one factor, so what all
later steps would add is the last block times q / (1 - q), q the ratio of the last two blocks'
power. In a closed room 64 steps hold .82 of the light and .99 with the tail.

The paper's scheme clamps negative intensities, so it is not linear in the state; there every
state is accumulated, the first step free, as the paper says.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import Placement
from ..maths.lattice6 import SPREAD_KEPT, Hop, Scheme, hops
from .columns import column_march
from .storage import Format, Pack
from .sums import FLOAT, Sums

CHANNELS = 3
BLOCK = 8  # states that are summed by doubling
_TAIL_BLOCKS = 4  # fewer do not know the slowest mode yet
_CPU_TILE, _CPU_OPEN_TILE, _CPU_SLAB = (2, 4), (4, 4), 8  # measured best on a software driver


class StepParams(Struct):
    """The lattice's size, and what the step does."""

    count = vec3u("cells")
    kept = f32("share of negative power into closed faces that is handed back")


class Propagate:
    """Iterates steps between lattices of its own.

    `scheme` is "centroid" or "paper"; with `is_blocked` each hop loses its blocked share, and
    with `is_reflecting` that share bounces into its own cell (Kaplanyan2010 section 7), coloured
    by the face's reflectance. `storage` is how states are kept (lpv.storage).
    differs: the paper reflects what arrives before a blocker one cell further; so does "paper".
    """

    def __init__(
        self, gpu: Gpu, placement: Placement, scheme: Scheme = "centroid", *, is_blocked: bool,
        is_reflecting: bool = False, storage: str = "float32", kept: float = SPREAD_KEPT,
    ) -> None:  # fmt: skip
        """`kept`: of the spread of directions in a hop (`maths.lattice6.spread_kept`)."""
        self.scheme, self.placement = scheme, placement
        self._pack = Pack(gpu, storage)
        format = self._pack.format

        def step(blocked: bool, *, is_added: bool = False) -> _Step:
            return _Step(
                gpu, placement.count, scheme, format, is_blocked=blocked,
                is_reflecting=blocked and is_reflecting, is_added=is_added, kept=kept,
            )  # fmt: skip

        self._later = step(is_blocked)
        # The paper's first step ignores blockers.
        self._first = step(False) if is_blocked and scheme == "paper" else self._later
        self._added = self._later if scheme == "paper" else step(is_blocked, is_added=True)
        names = ("light of a block", "propagation ping", "propagation pong")
        self._values = CHANNELS * placement.cells
        self._states = [Buffer(gpu, name, self._values * format.nbytes) for name in names]
        self._total = Buffer(gpu, "propagated light", self._values * 16)
        self._sums = Sums(gpu, placement.cells, format, self._pack.range)

    def encode(
        self, commands: Commands, injected: Buffer, faces: Buffer, iterations: int, *,
        has_tail: bool = False,
    ) -> Buffer:  # fmt: skip
        """The sum of the states after 1 to `iterations` steps from `injected`, without itself.

        `has_tail`: with what all later steps would add, estimated (from 32 iterations on).
        """
        block, ping, pong = self._states
        total = self._total
        blocks = 0 if self.scheme == "paper" else iterations // BLOCK
        # One block is the sum, where states are kept as sums are.
        is_block = iterations == BLOCK and blocks == 1 and self._pack.format is FLOAT
        if not is_block:
            commands.encoder.clear_buffer(total.handle)
        if iterations < 1:
            return total
        # Shaped lobes are negative behind their surface, which their power is scaled for: what
        # they would send there is dropped (lattice.inject).
        self._first.encode(commands, self._stored(commands, injected), block, faces, kept=0.0)
        for left in range(iterations - BLOCK * blocks, 0, -1):
            self._sums.add_to_total(commands, block, total)
            if left > 1 or blocks:
                self._later.encode(commands, block, ping, faces)
                block, ping = ping, block
        if not blocks:
            return total
        block, spare = self._doubled(commands, block, (ping, pong), faces)
        if is_block:
            return block
        self._sum_blocks(commands, block, total, spare, faces, blocks, has_tail=has_tail)
        return total

    def _doubled(
        self, commands: Commands, state: Buffer, spare: tuple[Buffer, Buffer], faces: Buffer
    ) -> tuple[Buffer, tuple[Buffer, Buffer]]:
        """The sum of BLOCK states, the first `state`; and the lattices that are spare now."""
        for doubling in range(BLOCK.bit_length() - 1):
            steps = (1 << doubling) - 1
            later = self._stepped(commands, state, spare, faces, steps)
            last = spare[steps % 2]
            self._added.encode(commands, later, last, faces, added=state)
            state, spare = last, (state, spare[1 - steps % 2])
        return state, spare

    def _sum_blocks(
        self, commands: Commands, block: Buffer, total: Buffer, spare: tuple[Buffer, Buffer],
        faces: Buffer, blocks: int, *, has_tail: bool,
    ) -> None:  # fmt: skip
        """Add `blocks` times BLOCK states to `total`, the sum of the first of them in `block`."""
        self._sums.add_to_total(commands, block, total)
        has_tail = has_tail and blocks >= _TAIL_BLOCKS
        for index in range(1, blocks):
            if has_tail and index == blocks - 1:
                self._sums.measure(commands, block, 0)
            later = self._stepped(commands, block, spare, faces, BLOCK)
            self._sums.add_to_total(commands, later, total)
            block, spare = later, (spare[0], block)
        if has_tail:
            self._sums.measure(commands, block, 1)
            self._sums.add_to_total(commands, block, total, is_tail=True)

    def _stored(self, commands: Commands, injected: Buffer) -> Buffer:
        """The injected light as states are kept."""
        if self._pack.format.largest == 0.0:
            return injected
        stored = self._states[1]
        self._pack.encode(commands, injected, stored, self._values)
        return stored

    def _stepped(
        self, commands: Commands, state: Buffer, spare: tuple[Buffer, Buffer], faces: Buffer,
        steps: int,
    ) -> Buffer:  # fmt: skip
        """What `state` has become after `steps` steps, in one of the `spare` lattices."""
        for index in range(steps):
            self._later.encode(commands, state, spare[index % 2], faces)
            state = spare[index % 2]
        return state

    def release(self) -> None:
        """Give the memory back."""
        for buffer in (*self._states, self._total):
            buffer.release()
        self._sums.release()
        self._pack.release()


class _Step:
    """One step, in columns marched along z (lpv.columns).

    Where faces block, an invocation has all channels, which share them; else one. With `is_added` a
    lattice is added to what the step makes.
    """

    def __init__(
        self, gpu: Gpu, count: tuple[int, int, int], scheme: Scheme, format: Format, *,
        is_blocked: bool, is_reflecting: bool, kept: float, is_added: bool = False,
    ) -> None:  # fmt: skip
        tile = _CPU_TILE if is_blocked else _CPU_OPEN_TILE
        width, height = (min(t, n) if gpu.is_cpu else 1 for t, n in zip(tile, count, strict=False))
        slab, channels = _CPU_SLAB if gpu.is_cpu else 1, 1 if is_blocked else CHANNELS
        self._count = count
        self._columns = (
            -(-count[0] // width), -(-count[1] // height), channels * -(-count[2] // slab)
        )  # fmt: skip
        text = format.wgsl + pair_functions(scheme, kept)
        if is_blocked:
            text += Path(__file__).with_name(f"propagate_{scheme}.wgsl").read_text()
        self._pass = _step_pass(
            gpu, format, text + column_march(width, height, slab, channels),
            "propagate.wgsl" if is_blocked else "propagate_open.wgsl",
            {
                "IS_ADDED": float(is_added),
                **({"IS_REFLECTING": float(is_reflecting)} if is_blocked else {}),
            },
        )  # fmt: skip

    def encode(
        self, commands: Commands, before: Buffer, after: Buffer, faces: Buffer,
        kept: float = 1.0, added: Buffer | None = None,
    ) -> None:  # fmt: skip
        """after = M before + added. `kept`: what closed faces hand back of wrong-signed power."""
        self._pass.dispatch(
            commands, self._columns, params=StepParams.of(count=self._count, kept=kept),
            before=before, after=after, faces=faces, added=added or before,
        )  # fmt: skip


def _step_pass(
    gpu: Gpu, format: Format, text: str, wgsl: str, constants: dict[str, float]
) -> ComputePass:
    class Step(ComputePass):
        slots = (
            uniform("params", StepParams),
            storage("before", format.element),
            storage("after", format.element, "read_write"),
            storage("faces", "vec4u"),
            storage("added", format.element),
        )
        # One run of lanes: a software driver runs groups without work, too.
        workgroup = (8, 1, 1) if gpu.is_cpu else (32, 8, 1)
        file = wgsl

    return Step(gpu, generated=text, constants=constants)


def pair_functions(scheme: Scheme, kept: float = SPREAD_KEPT) -> str:
    """WGSL of `along_x`, `along_y`, `along_z`: what two opposite neighbours' light adds.

    `kept`: of the spread of directions (`maths.lattice6.spread_kept`).

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
    return shares + "\n".join(_linear_pair(k, axis, kept) for k, axis in enumerate("xyz")) + "\n"


def _linear_pair(index: int, axis: str, kept: float) -> str:
    """Opposite hops differ in the sign of what couples a with b along the axis."""
    matrix, b = hops("centroid", kept)[2 * index].matrix, index + 1
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
