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
state is accumulated, and the first step ignores blockers, as the paper says.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.recorded import Recorded
from ..lattice.placement import Placement
from .step import CHANNELS, Step, StepKind
from .storage import FLOAT, Pack
from .sums import Sums

BLOCK = 8  # states that are summed by doubling
_TAIL_BLOCKS = 4  # fewer do not know the slowest mode yet


class Propagate:
    """Iterates steps of one kind between lattices of its own."""

    def __init__(
        self, gpu: Gpu, placement: Placement, kind: StepKind, storage: str = "float32"
    ) -> None:
        """`storage`: how states are stored (lpv.storage)."""
        self.placement, self.is_paper = placement, kind.scheme == "paper"
        self._pack = Pack(gpu, storage)
        format = self._pack.format
        # The kernels: of the first step, of later ones, of those that end a doubling.
        self._later = Step(gpu, placement.count, kind, format)
        self._first = self._added = self._later
        if self.is_paper and kind.is_blocked:
            open_space = replace(kind, is_blocked=False, is_reflecting=False)
            self._first = Step(gpu, placement.count, open_space, format)
        if not self.is_paper:
            self._added = Step(gpu, placement.count, replace(kind, is_added=True), format)
        # Three lattices of states, and the sum.
        names = ("light of a block", "propagation ping", "propagation pong")
        self._values = CHANNELS * placement.cells
        self._states = [Buffer(gpu, name, self._values * format.nbytes) for name in names]
        self._total = Buffer(gpu, "propagated light", self._values * 16)
        self._sums = Sums(gpu, placement.cells, format, self._pack.range)
        self._recorded = Recorded(gpu, "propagation steps")

    def encode(
        self,
        commands: Commands,
        injected: Buffer,
        faces: Buffer,
        iterations: int,
        *,
        has_tail: bool = False,
    ) -> Buffer:
        """The sum of the states after 1 to `iterations` steps from `injected`, without itself.

        `has_tail`: with what all later steps would add, estimated (from 32 iterations on).
        """
        if iterations < 1:
            commands.encoder.clear_buffer(self._total.handle)
            return self._total
        return self._recorded.encode(
            commands,
            (injected, faces, iterations, has_tail),
            partial(self._summed, commands, injected, faces, iterations, has_tail=has_tail),
        )

    def _summed(
        self,
        commands: Commands,
        injected: Buffer,
        faces: Buffer,
        iterations: int,
        *,
        has_tail: bool,
    ) -> Buffer:
        """All steps, one by one and then in blocks; the sum."""
        (block, ping, pong), total = self._states, self._total
        # The paper's steps clamp, so that blocks of them are no sums.
        blocks = 0 if self.is_paper else iterations // BLOCK
        singles = iterations - BLOCK * blocks
        # The first step. Shaped lobes are negative behind their surface, which their power is
        # scaled for: what they would send there is dropped (lattice.inject).
        self._first.encode(commands, self._stored(commands, injected), block, faces, handed_back=0)
        # Steps that make no whole block are added one by one.
        for left in range(singles, 0, -1):
            self._sums.add_to_total(commands, block, total, is_first=left == singles)
            if left > 1 or blocks:
                self._later.encode(commands, block, ping, faces)
                block, ping = ping, block
        if not blocks:
            return total
        # The sum of the next eight states, then blocks of eight later ones.
        block, spare = self._doubled(commands, block, (ping, pong), faces)
        if blocks == 1 and not singles and self._pack.format is FLOAT:
            return block  # it is all there is, and stored as the total is
        self._sums.add_to_total(commands, block, total, is_first=not singles)
        self._add_blocks(commands, block, spare, faces, blocks, has_tail=has_tail)
        return total

    def _doubled(
        self, commands: Commands, state: Buffer, spare: tuple[Buffer, Buffer], faces: Buffer
    ) -> tuple[Buffer, tuple[Buffer, Buffer]]:
        """The sum of BLOCK states, the first `state`; and the two lattices that are spare then."""
        # S = (1 + M^4)(1 + M^2)(1 + M) s: the last step of each factor adds what it multiplies.
        for doubling in range(BLOCK.bit_length() - 1):
            steps = (1 << doubling) - 1
            later = self._stepped(commands, state, spare, faces, steps)
            last = spare[steps % 2]
            self._added.encode(commands, later, last, faces, added=state)
            state, spare = last, (state, spare[1 - steps % 2])
        return state, spare

    def _add_blocks(
        self,
        commands: Commands,
        block: Buffer,
        spare: tuple[Buffer, Buffer],
        faces: Buffer,
        blocks: int,
        *,
        has_tail: bool,
    ) -> None:
        """Add what `block` becomes after eight steps, sixteen ... to the total, and the tail."""
        has_tail = has_tail and blocks >= _TAIL_BLOCKS
        # A block is a sum of states: as many steps turn it into the sum of the next ones.
        for index in range(1, blocks):
            if has_tail and index == blocks - 1:
                self._sums.measure(commands, block, 0)
            later = self._stepped(commands, block, spare, faces, BLOCK)
            self._sums.add_to_total(commands, later, self._total)
            block, spare = later, (spare[0], block)
        # The ratio of the last two blocks' power says how all later ones shrink.
        if has_tail:
            self._sums.measure(commands, block, 1)
            self._sums.add_to_total(commands, block, self._total, is_tail=True)

    def _stored(self, commands: Commands, injected: Buffer) -> Buffer:
        """The injected light as states are stored."""
        # Packed from the injected light, which stays as it is.
        if self._pack.format.largest == 0.0:
            return injected
        stored = self._states[1]
        self._pack.encode(commands, injected, stored, self._values)
        return stored

    def _stepped(
        self,
        commands: Commands,
        state: Buffer,
        spare: tuple[Buffer, Buffer],
        faces: Buffer,
        steps: int,
    ) -> Buffer:
        """What `state` has become after `steps` steps, in one of the `spare` lattices."""
        for index in range(steps):
            self._later.encode(commands, state, spare[index % 2], faces)
            state = spare[index % 2]
        return state
