"""The smallest lattices of the stack, all of whose steps and corrections are one dispatch.

A lattice of some hundred cells keeps a device busy for less time than its dispatch takes to begin,
and W cycles visit the coarsest ones most: of the dispatches of a frame nine in ten were theirs. One
workgroup per channel runs a list of what else would be dispatched, with barriers in between. The
same steps as Levels', the residual's products added in another order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, pack_array, u32, vec3f, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage
from .coefficients import CHANNELS, StepCoefficients
from .correction import BOLD
from .hop_wgsl import constants, gathered, gathered_blocked, offsets
from .propagate import MOVE, TRACK
from .schedule import Count, Schedule

MOST_CELLS = 512
_THREADS, _CPU_THREADS = 256, 8  # a CPU adapter's barriers cost nothing within one vector
_NOTHING, _RESTRICT, _PROLONG, _CORRECT = range(4)


class SmallStep(Struct):
    """after = source + K before; places are of the first element."""

    count = vec3u("cells")
    row = u32("of the coefficients, for channel 0")
    before = u32()
    source = u32()
    after = u32()
    cell = u32("the lattice's first, in what cells have besides light")


class SmallStage(Struct):
    """A run of steps, and what is done with the last one's result."""

    fine = vec3u("cells")
    first = u32("step")
    coarse = vec3u("cells")
    end = u32("step")
    kind = u32("0 nothing, 1 restrict, 2 prolong, 3 correct")
    level = u32("the finer")
    cell = u32("the finer lattice's first")
    current = u32("first element of the sum so far")
    given = u32("restrict, correct: the stepped sum; prolong: the coarse track")
    change = u32("prolong, correct: the correction")
    answer = u32("correct: the correction stepped")
    made = u32("restrict: the residual; prolong: the correction; correct: the corrected sum")


class SmallLevel(Struct):
    """What prolonging needs to know."""

    way = vec3f("m of track per hop of isotropic light, by channel")
    has_walls = f32("0 or 1")


class _Small(ComputePass):
    slots = (
        storage("steps", SmallStep),
        storage("stages", SmallStage),
        storage("levels", SmallLevel),
        storage("coefficients", StepCoefficients),
        storage("packs", "vec4u"),
        storage("face_visibility", "vec2u"),
        storage("states", "vec4f", "read_write"),
    )
    file = "small_levels.wgsl"

    def __init__(self, gpu: Gpu, generated: str) -> None:
        self.workgroup = (_CPU_THREADS if gpu.takes_cpu_paths else _THREADS, 1, 1)  # type: ignore[misc]
        super().__init__(gpu, generated=generated)


class Part:
    """A part of a buffer, bound by itself."""

    def __init__(self, buffer: Buffer, offset: int, nbytes: int) -> None:
        self.resource: Any = {"buffer": buffer.handle, "offset": offset, "size": nbytes}


class _Places:
    """Where a level's lattices begin, in elements of `states`."""

    def __init__(self, at: int, count: Count) -> None:
        self.count, self.cells = count, count[0] * count[1] * count[2]
        self.stride = -(-CHANNELS * self.cells // 16) * 16  # 256 bytes, which bindings ask for
        self.source, self.sum, self.spare, self.track, self.answer, self.zero = (
            at + k * self.stride for k in range(6)
        )
        self.end = at + 6 * self.stride


class SmallLevels:
    """Runs the cycles of levels `first` and beyond of a stack, and takes the result's track."""

    def __init__(
        self, gpu: Gpu, counts: Sequence[Count], plan: Schedule, first: int, *, is_blocked: bool
    ) -> None:
        self.first, self._plan, self._is_blocked = first, plan, is_blocked
        self._places: list[_Places] = []
        for count in counts[first:]:
            self._places.append(_Places(self._places[-1].end if self._places else 0, count))
        self._cells = np.cumsum([0, *(p.cells for p in self._places)]).tolist()
        self._states = Buffer(gpu, "light of small lattices", 16 * self._places[-1].end)
        top = self._places[0]
        nbytes = 16 * CHANNELS * top.cells
        self.source, self.track = (
            Part(self._states, 16 * at, nbytes) for at in (top.source, top.track)
        )
        cells = self._cells[-1] if is_blocked else 1
        self._packs = Buffer(gpu, "hops of small lattices", 64 * cells)
        self._face_visibility = Buffer(gpu, "visibility of small lattices", 8 * cells)
        self._steps: list[dict[str, Any]] = []
        self._stages: list[dict[str, Any]] = []
        self._plan_visits()
        self._tables = [Buffer(gpu, name, x.nbytes) for name, x in self._packed().items()]
        for table, packed in zip(self._tables, self._packed().values(), strict=True):
            table.write(packed)
        self._levels = Buffer(gpu, "ways", SmallLevel.dtype.itemsize * len(counts))
        walls = gathered_blocked() if is_blocked else gathered()
        self._pass = _Small(gpu, f"{constants()}\n{walls}\n{_wgsl(is_blocked)}")

    def _packed(self) -> dict[str, Any]:
        return {
            "small steps": pack_array(SmallStep, self._steps),
            "small stages": pack_array(SmallStage, self._stages),
        }

    def set_air(self, ways: Sequence[Sequence[float]]) -> None:
        """Metres of track per hop of isotropic light, of every level's three channels."""
        rows = [{"way": way, "has_walls": float(self._is_blocked)} for way in ways]
        self._levels.write(pack_array(SmallLevel, rows))

    def set_walls(self, commands: Commands, k: int, packs: Buffer, face_visibility: Buffer) -> None:
        """Take on level `k`'s walls, as Levels has them."""
        at = self._cells[k - self.first]
        cells = self._places[k - self.first].cells
        walls = ((packs, self._packs, 64), (face_visibility, self._face_visibility, 8))
        for given, kept, size in walls:
            commands.encoder.copy_buffer_to_buffer(
                given.handle, 0, kept.handle, size * at, size * cells
            )

    def encode(self, commands: Commands, coefficients: Buffer) -> None:
        """`track` becomes the track of what is solved for `source`."""
        self._pass.dispatch(
            commands,
            (self._pass.workgroup[0], CHANNELS),
            steps=self._tables[0],
            stages=self._tables[1],
            levels=self._levels,
            coefficients=coefficients,
            packs=self._packs,
            face_visibility=self._face_visibility,
            states=self._states,
        )

    def _plan_visits(self) -> None:
        top = self._places[0]
        found = top.source
        for _ in range(self._plan.visits):
            found = self._cycle(0, found)
        self._step(0, TRACK, found, top.zero, top.track)
        self._stage(0, _NOTHING)

    def _cycle(self, k: int, current: int) -> int:
        """As Levels has it; k counts from `first`."""
        level = k + self.first
        for _ in range(self._plan.before[level]):
            current = self._smoothed(k, current)
        left = self._plan.after[level]
        if k + 1 < len(self._places):
            current = self._corrected(k, current)
            left -= 1
        for _ in range(left):
            current = self._smoothed(k, current)
        return current

    def _corrected(self, k: int, current: int) -> int:
        own, coarse = self._places[k], self._places[k + 1]
        stepped = self._smoothed(k, current)
        self._stage(k, _RESTRICT, current=current, given=stepped, made=coarse.source)
        found = coarse.source
        for _ in range(self._plan.visits):
            found = self._cycle(k + 1, found)
        self._step(k + 1, TRACK, found, coarse.zero, coarse.track)
        self._stage(k, _PROLONG, current=current, given=coarse.track, made=own.track)
        self._step(k, MOVE, own.track, own.zero, own.answer)
        corrected = own.spare if stepped == own.sum else own.sum
        self._stage(
            k,
            _CORRECT,
            current=current,
            given=stepped,
            change=own.track,
            answer=own.answer,
            made=corrected,
        )
        return corrected

    def _smoothed(self, k: int, current: int) -> int:
        own = self._places[k]
        target = own.spare if current == own.sum else own.sum
        self._step(k, MOVE, current, own.source, target)
        return target

    def _step(self, k: int, row: int, before: int, source: int, after: int) -> None:
        self._steps.append(
            {
                "count": self._places[k].count,
                "row": 2 * CHANNELS * (k + self.first) + row,
                "before": before,
                "source": source,
                "after": after,
                "cell": self._cells[k],
            }
        )

    def _stage(self, k: int, kind: int, **places: int) -> None:
        """What has been planned since the last stage, and what follows it."""
        coarse = self._places[min(k + 1, len(self._places) - 1)]
        first = self._stages[-1]["end"] if self._stages else 0
        named = {
            name: places.get(name, 0) for name in ("current", "given", "change", "answer", "made")
        }
        self._stages.append(
            {
                "fine": self._places[k].count,
                "coarse": coarse.count,
                "first": first,
                "end": len(self._steps),
                "kind": kind,
                "level": k + self.first,
                "cell": self._cells[k],
                **named,
            }
        )


def first_small(counts: Sequence[Count]) -> int | None:
    """The finest coarse level that is small; none where none is."""
    return next((k for k, n in enumerate(counts) if k and n[0] * n[1] * n[2] <= MOST_CELLS), None)


def _wgsl(is_blocked: bool) -> str:
    """`stepped`: what cell `at` holds next, its neighbours loaded one by one."""
    names = ["c", "own"]
    lines = [
        f"const MOST = {BOLD};",
        "fn stepped(c: StepCoefficients, s: SmallStep, at: vec3u, channel: u32, cell: u32)"
        " -> vec4f {",
        "    let n = s.count;",
        "    let lattice = s.before + channel * n.x * n.y * n.z;",
        "    let low = max(at, vec3u(1u)) - 1u;",
        "    let high = min(at + 1u, n - 1u);",
        "    let is_low = at > vec3u(0u);",
        "    let is_high = at + 1u < n;",
        "    let own = states[lattice + cell] * c.gain;",
    ]
    for j, offset in enumerate(offsets()):
        places = [
            {-1: "low", 0: "at", 1: "high"}[k] + f".{axis}"
            for k, axis in zip(offset, "xyz", strict=True)
        ]
        inside = " && ".join(
            {-1: "is_low", 1: "is_high"}[k] + f".{axis}"
            for k, axis in zip(offset, "xyz", strict=True)
            if k
        )
        x, y, z = places
        lines.append(
            f"    let n{j} = states[lattice + ({z} * n.y + {y}) * n.x + {x}]"
            f" * select(vec4f(0.0), c.gain, {inside});"
        )
        names.append(f"n{j}")
    if is_blocked:
        lines.append("    let p = 4u * (s.cell + cell);")
        names += ["packs[p]", "packs[p + 1u]", "packs[p + 2u]", "packs[p + 3u]", "channel"]
    function = "gathered_blocked" if is_blocked else "gathered"
    return "\n".join([*lines, f"    return {function}({', '.join(names)});", "}"])
