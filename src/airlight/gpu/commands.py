"""The command encoder of a frame: passes, their uniforms, and the time of each stage.

The uniforms of a frame lie in one buffer, each dispatch's at an offset of its own, because a buffer
rewritten between dispatches of one submit would show only its last value to all of them.
"""

from __future__ import annotations

import time
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import wgpu

from .device import Gpu
from .layout import Struct
from .recorded import Dispatch
from .tally import Tally

_ALIGNMENT = 256  # of dynamic uniform offsets, WebGPU's default limit
_ARENA_BYTES = 1 << 20
_ROOM_BYTES = 1 << 16  # for the parameters of one pass
_MAX_TIMESTAMPS = 512


class Commands:
    """Encodes one frame after the other; it is reused, so that a frame allocates nothing."""

    is_recordable = True
    """Whether dispatches in a row may share a pass, and so be replayed (see recorded)."""

    @property
    def is_wanted(self) -> bool:
        """Whether anybody waits for what is encoded; else its longest parts may be left out."""
        return True

    def __init__(self, gpu: Gpu) -> None:
        self.gpu = gpu
        usage = wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        with gpu.guarded():
            self.arena: Any = gpu.device.create_buffer(
                label="uniforms", size=_ARENA_BYTES, usage=usage
            )

        # Parameters are staged until the submit, each at its place.
        self._staging = bytearray(_ARENA_BYTES)
        self._used = 0
        self._places: dict[int, tuple[int, Struct]] = {}  # by id, which is theirs while kept here
        self.pipeline: Any = None
        self.recording: list[Dispatch] | None = None  # what is being recorded

        # What is open: the frame's encoder, and its compute pass.
        self._encoder: Any = None
        self._compute: Any = None
        self.stage_ms: dict[str, float] = {}
        self.tally: Tally | None = None  # where passes are counted; recordings are not
        self.is_timed = False
        self._stage = ""
        self._clock = _Timestamps(gpu) if "timestamp-query" in gpu.features else None

    @property
    def encoder(self) -> Any:
        """The command encoder; any open compute pass is closed first."""
        if self.recording is not None:
            raise RuntimeError("only dispatches can be recorded")
        return self._opened()

    def _opened(self) -> Any:
        self._close_compute()
        if self._encoder is None:
            self._encoder = self.gpu.device.create_command_encoder(label="frame")
        return self._encoder

    @property
    def compute(self) -> Any:
        """The open compute pass; dispatches in a row share one, `pipeline` the last one set."""
        if self._compute is None:
            encoder = self._opened()
            stamps = self._stamps()
            self.pipeline = None
            self._compute = encoder.begin_compute_pass(
                label=self._stage or "compute", **({"timestamp_writes": stamps} if stamps else {})
            )
        return self._compute

    def compute_by(self, pipeline: Any) -> Any:
        """The same with a `pipeline`, which is set only where it changes."""
        encoder = self.compute
        if self.pipeline is not pipeline:
            self.pipeline = pipeline
            encoder.set_pipeline(pipeline)
        return encoder

    @contextmanager
    def render(self, label: str, **attachments: Any) -> Iterator[Any]:
        """A render pass onto the given attachments."""
        self.make_room()
        stamps = self._stamps()
        extra = {"timestamp_writes": stamps} if stamps else {}
        render_pass = self.encoder.begin_render_pass(label=label, **attachments, **extra)
        try:
            yield render_pass
        finally:
            render_pass.end()

    def bands(self, key: Hashable, count: int, layer: int = 1) -> Iterator[tuple[int, int]]:
        """The bands of a pass of `count` rows, as (first, how many): here, one.

        `key` names the pass, and what else its time depends on. A band is whole layers, of so many
        rows, or lies within a `layer`.
        """
        yield 0, count

    def make_room(self, nbytes: int = _ROOM_BYTES) -> None:
        """Submit what is encoded where the arena has less than `nbytes` left.

        Passes call it before the first of their parameters: a frame of any number of passes fits.
        """
        if self._used + nbytes > _ARENA_BYTES and self.recording is None:
            self.submit()

    def make_room_for_recording(self) -> None:
        """The same for a run of dispatches, within which nothing is submitted."""
        self.make_room(_ARENA_BYTES // 2)

    def put(self, params: object) -> int:
        """Store `params` until the submit; returns their offset in the arena.

        The same Struct has one offset, however often a frame uses it.
        """
        # Parameters that were stored before have one copy in a frame.
        found = self._places.get(id(params))
        if found is not None:
            return found[0]
        if not isinstance(params, Struct):
            kind = type(params).__name__
            raise TypeError(f"uniform parameters must be a Struct, not {kind}")
        # Offsets are aligned as WebGPU asks of dynamic ones.
        data = params.data
        size = len(data)

        # An arena that is full cannot grow: offsets of this frame's parameters point into it.
        if self._used + size > _ARENA_BYTES:
            raise RuntimeError(
                "uniform arena is full: too many parameters of one pass or recording"
            )
        offset = self._used
        self._staging[offset : offset + size] = data
        self._used = -(-(offset + size) // _ALIGNMENT) * _ALIGNMENT
        self._places[id(params)] = (offset, params)
        return offset

    def submit(self) -> None:
        """Submit all that was encoded to the device."""
        if self.recording is not None:
            raise RuntimeError("only dispatches can be recorded")
        self._close_compute()
        if self._encoder is None:
            return
        if self._clock and self._clock.count:
            self._clock.resolve(self._encoder)
        # All parameters of the frame go over in one write, before what reads them.
        with self.gpu.guarded():
            if self._used:
                self.gpu.queue.write_buffer(self.arena, 0, self._staging, 0, self._used)
            self.gpu.queue.submit([self._encoder.finish(label="frame")])
        self._encoder, self._used = None, 0
        self._places.clear()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """A context whose passes count as `name`, and are timed where `is_timed`.

        A CPU adapter's timestamps mean nothing, so there each stage is a submit of its own and the
        wall clock is read; on a GPU the passes carry timestamp queries.
        """
        outer, self._stage = self._stage, name
        on_wall = self.is_timed and (self.gpu.is_cpu or self._clock is None)
        # What came before must not be counted: passes end, and on a wall clock the device is idle.
        if self.is_timed:
            self._close_compute()
        # A stage whose passes have nothing to do took no time.
        if self.is_timed and not on_wall:
            self.stage_ms.setdefault(name, 0.0)
        if on_wall and not outer:
            self.submit()
            self.gpu.wait()
        begin = time.perf_counter()
        try:
            yield
        finally:
            if self.is_timed:
                self._close_compute()

            # Nested stages count in the wall time of the outer one.
            if on_wall and not outer:
                self.submit()
                self.gpu.wait()
                spent_ms = (time.perf_counter() - begin) * 1e3
                self.stage_ms[name] = self.stage_ms.get(name, 0.0) + spent_ms
            self._stage = outer

    @property
    def stage_name(self) -> str:
        """The stage that is being encoded."""
        return self._stage or "other"

    def collect_timestamps(self) -> None:
        """Add the last submit's timestamp queries to `stage_ms`; waits for the device."""
        if self._clock:
            for name, spent_ms in self._clock.collect():
                self.stage_ms[name] = self.stage_ms.get(name, 0.0) + spent_ms

    def _stamps(self) -> dict[str, Any] | None:
        if not (self.is_timed and self._clock and not self.gpu.is_cpu):
            return None
        return self._clock.next(self._stage or "other")

    def _close_compute(self) -> None:
        if self._compute is not None:
            self._compute.end()
            self._compute = None


class _Timestamps:
    """Begin and end of every pass of a frame, in device nanoseconds."""

    def __init__(self, gpu: Gpu) -> None:
        self.gpu = gpu
        self.names: list[str] = []
        self._queries: Any = None

    @property
    def count(self) -> int:
        return 2 * len(self.names)

    def next(self, name: str) -> dict[str, Any] | None:
        # Frames of more passes than there are queries are timed in part.
        if self.count + 2 > _MAX_TIMESTAMPS:
            return None
        # Made when they are first asked for: most runs time nothing.
        if self._queries is None:
            self._queries = self.gpu.device.create_query_set(
                label="stages", type="timestamp", count=_MAX_TIMESTAMPS
            )
            usage = wgpu.BufferUsage.QUERY_RESOLVE | wgpu.BufferUsage.COPY_SRC
            self._buffer = self.gpu.device.create_buffer(
                label="stages", size=8 * _MAX_TIMESTAMPS, usage=usage
            )

        # Two queries to a pass, where it begins and where it ends.
        first = self.count
        self.names.append(name)
        return {
            "query_set": self._queries,
            "beginning_of_pass_write_index": first,
            "end_of_pass_write_index": first + 1,
        }

    def resolve(self, encoder: Any) -> None:
        encoder.resolve_query_set(self._queries, 0, self.count, self._buffer, 0)

    def collect(self) -> list[tuple[str, float]]:
        if not self.names:
            return []
        names, self.names = self.names, []

        # Pairs of device times in nanoseconds.
        raw = self.gpu.queue.read_buffer(self._buffer, 0, 16 * len(names))
        ticks = np.frombuffer(raw, np.uint64).reshape(-1, 2).astype(np.int64)
        return [(n, float(b - a) * 1e-6) for n, (a, b) in zip(names, ticks, strict=True)]
