"""Dispatches that stay the same from frame to frame: recorded once, then encoded in a tight loop.

A lattice's multigrid cycles are hundreds of dispatches, each with the pipeline, bind group,
parameters and workgroups that it had in the frame before; to find them anew takes longer than to
hand them over.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import wgpu
from wgpu.backends.wgpu_native import ffi, lib

from .layout import Struct
from .quick_types import dispatch_calls

if TYPE_CHECKING:
    from .bindings import Bindings
    from .commands import Commands
    from .device import Gpu

_ALIGNMENT = 256  # of dynamic offsets, WebGPU's default limit
_CALLS = dispatch_calls(lib, ffi)
T = TypeVar("T")


class Changing:
    """Parameters that may be others in every run: a replay reads `params` as they are then."""

    def __init__(self, params: Struct) -> None:
        self.params = params


@dataclass(frozen=True)
class Dispatch:
    """One dispatch as it was encoded."""

    pipeline: Any
    bindings: Bindings
    values: dict[str, Any]
    groups: tuple[int, ...]


_Row = tuple[Any, Any, Any, tuple[tuple[int, Changing], ...], tuple[int, ...]]
"""Pipeline and bind group (None: as before), offsets, which of them change, workgroups."""


class Recorded:
    """A run of dispatches, made anew where the key it is asked for by is another."""

    def __init__(self, gpu: Gpu, label: str) -> None:
        self._gpu, self.label = gpu, label
        self._key: tuple[Any, ...] | None = None
        self._rows: list[_Row] = []
        self._kept: tuple[Any, ...] = ()  # an id stays a resource's while it lives
        self._found: Any = None
        self._last: Any = None

    def encode(self, commands: Commands, key: tuple[Any, ...], encode: Callable[[], T]) -> T:
        """What `encode()` encodes and returns, replayed as long as `key` is equal.

        `key` names all that the run depends on: resources (which compare by identity), counts,
        and whatever goes into parameters that are not Changing. Within `encode` there are
        dispatches only: no copies, draws, submits or writes from the host.
        """
        if not commands.is_recordable or commands.recording is not None:
            return encode()
        whole = (commands, *key)
        if whole != self._key:
            self._key, commands.recording = None, []
            try:
                self._found = encode()
                self._seal(commands, commands.recording)
            finally:
                commands.recording = None
            self._key = whole
        elif self._rows:
            self._replay(commands)
        found: T = self._found
        return found

    def _seal(self, commands: Commands, dispatches: list[Dispatch]) -> None:
        """Constant parameters go into a buffer of their own, so that their offsets stay."""
        places, fixed = self._fixed(dispatches)
        made: dict[tuple[int, ...], Any] = {}
        self._rows, self._last = [], None
        last: tuple[Any, ...] = ()
        for d in dispatches:
            given = [d.values[name] for name in d.bindings.dynamic]
            changing = tuple((i, v) for i, v in enumerate(given) if isinstance(v, Changing))
            offsets = [0 if isinstance(v, Changing) else places[v.data] for v in given]
            key = (id(d.bindings), *(id(d.values[name]) for name in d.bindings.fixed),
                   *(i for i, _ in changing))  # fmt: skip
            if key not in made:
                made[key] = d.bindings.make(commands, d.values, fixed)
            this = (d.pipeline, made[key], offsets)
            is_set = not changing and last == this
            pipeline = None if self._last is d.pipeline else d.pipeline
            self._rows.append(
                _row(pipeline, None if is_set else made[key], offsets, changing, d.groups)
            )
            self._last, last = d.pipeline, () if changing else this
        self._kept = (fixed, dispatches, list(made.values()))

    def _fixed(self, dispatches: list[Dispatch]) -> tuple[dict[bytes, int], Any]:
        """Where each of the constant parameters lies, and the buffer."""
        places: dict[bytes, int] = {}
        data = bytearray()
        for value in (v for d in dispatches for v in d.values.values() if isinstance(v, Struct)):
            if value.data not in places:
                places[value.data] = len(data)
                data += value.data + bytes(-len(value.data) % _ALIGNMENT)
        usage = wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        fixed = self._gpu.device.create_buffer(
            label=self.label, size=max(_ALIGNMENT, len(data)), usage=usage
        )
        if data:
            self._gpu.queue.write_buffer(fixed, 0, data)
        return places, fixed

    def _replay(self, commands: Commands) -> None:
        encoder = commands.compute
        if _CALLS is None:
            self._replay_slowly(commands, encoder)
        else:
            set_pipeline, set_group, dispatch = _CALLS
            handle = encoder._internal
            for pipeline, group, offsets, changing, groups in self._rows:
                if pipeline is not None:
                    set_pipeline(handle, pipeline)
                for place, params in changing:
                    offsets[place] = commands.put(params)
                if group is not None:
                    set_group(handle, 0, group, len(offsets), offsets)
                dispatch(handle, *groups)
        commands.pipeline = self._last

    def _replay_slowly(self, commands: Commands, encoder: Any) -> None:
        """By wgpu-py's own methods."""
        for pipeline, group, offsets, changing, groups in self._rows:
            if pipeline is not None:
                encoder.set_pipeline(pipeline)
            for place, params in changing:
                offsets[place] = commands.put(params)
            if group is not None:
                encoder.set_bind_group(0, group, offsets)
            encoder.dispatch_workgroups(*groups)


def _row(
    pipeline: Any, group: Any, offsets: list[int], changing: tuple[tuple[int, Changing], ...],
    groups: tuple[int, ...],
) -> _Row:  # fmt: skip
    if _CALLS is None:
        return pipeline, group, offsets, changing, groups
    handles = [None if one is None else one._internal for one in (pipeline, group)]
    return handles[0], handles[1], ffi.new("uint32_t[]", offsets), changing, groups
