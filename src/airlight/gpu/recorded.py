"""Dispatches that stay the same from frame to frame: recorded once, then encoded in a tight loop.

A lattice's steps are a hundred dispatches, each with the pipeline, bind group,
parameters and workgroups that it had in the frame before; to look them up again takes longer than
to hand them over.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import wgpu
from wgpu.backends.wgpu_native import ffi, lib

from .layout import Struct

if TYPE_CHECKING:
    from .bindings import Bindings
    from .commands import Commands
    from .device import Gpu

_ALIGNMENT = 256  # of dynamic offsets, WebGPU's default limit
_MOST = 4  # recordings kept; each holds its parameters and bind groups
T = TypeVar("T")


@dataclass(frozen=True)
class Dispatch:
    """One dispatch as it was encoded."""

    pipeline: Any
    bindings: Bindings
    values: dict[str, Any]
    groups: tuple[int, ...]


_Row = tuple[Any, Any, Any, tuple[int, ...]]
"""Pipeline and bind group (None: as before), offsets, workgroups."""


class Recorded:
    """A run of dispatches, recorded once for each of the last few keys it is asked for by."""

    def __init__(self, gpu: Gpu, label: str) -> None:
        self._gpu, self.label = gpu, label
        self._recordings: dict[tuple[Any, ...], Recording] = {}  # the last used last
        gpu.own(self)

    def encode(self, commands: Commands, key: tuple[Any, ...], encode: Callable[[], T]) -> T:
        """What `encode()` encodes and returns, replayed as long as `key` is equal.

        `key` names all that the run depends on: resources, which compare by identity and live as
        long as they are named here, counts, and whatever goes into parameters. Within `encode`
        there are dispatches only: no copies, draws, submits or writes from the host.
        """
        if not commands.is_recordable or commands.recording is not None:
            return encode()
        # Replay what the same key encoded before; of recordings only the last few are kept.
        whole = (commands, *key)
        recording = self._recordings.pop(whole, None)
        if recording is None:
            recording = self._record(commands, encode)
            if len(self._recordings) >= _MOST:
                self._recordings.pop(next(iter(self._recordings))).release()
        else:
            recording.replay(commands)
        self._recordings[whole] = recording
        found: T = recording.found
        return found

    def _record(self, commands: Commands, encode: Callable[[], object]) -> Recording:
        commands.make_room_for_recording()
        commands.recording = []
        try:
            found = encode()
            return Recording(self._gpu, self.label, commands.recording, found)
        finally:
            commands.recording = None

    def release(self) -> None:
        """Give the memory back, and what recordings name."""
        for recording in self._recordings.values():
            recording.release()
        self._recordings.clear()


class Recording:
    """Dispatches with their pipelines, bind groups and parameters at hand; `found`: what encoding
    them returned.
    """

    nbytes = 0

    def __init__(self, gpu: Gpu, label: str, dispatches: list[Dispatch], found: object) -> None:
        self._gpu = gpu
        self.found: Any = found
        # Parameters go into a buffer of their own, so that their offsets stay.
        places, data = _packed(dispatches)
        usage = wgpu.BufferUsage.UNIFORM | wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_DST
        nbytes = max(_ALIGNMENT, len(data))
        with gpu.guarded():
            params = gpu.device.create_buffer(label=label, size=nbytes, usage=usage)
        self.nbytes = nbytes
        gpu.memory.count(nbytes)
        if data:
            gpu.queue.write_buffer(params, 0, data)
        # Rows to replay: what equals the row before is not set again.
        made: dict[tuple[int, ...], Any] = {}  # by ids, which are theirs as dispatches live
        self._rows: list[_Row] = []
        self._last: Any = None
        last: tuple[Any, ...] = ()
        for d in dispatches:
            offsets = [places[d.values[name].data] for name in d.bindings.dynamic]

            # Dispatches of the same bindings and resources share a bind group.
            key = (id(d.bindings), *(id(d.values[name]) for name in d.bindings.fixed))
            if key not in made:
                made[key] = d.bindings.make(d.values, params)
            this = (made[key], offsets)
            pipeline = None if self._last is d.pipeline else d.pipeline
            self._rows.append(_row(pipeline, None if last == this else made[key], offsets, d))
            self._last, last = d.pipeline, this

        # Rows hold bare handles, which are valid as long as these live.
        self._kept: tuple[Any, ...] = (params, dispatches, list(made.values()))

    def replay(self, commands: Commands) -> None:
        """Encode them."""
        if not self._rows:
            return
        # Straight to wgpu-native where its calls are known: wgpu-py checks each argument again.
        encoder = commands.compute
        if _CALLS is None:
            self._replay_slowly(encoder)
        else:
            set_pipeline, set_group, dispatch = _CALLS
            handle = encoder._internal
            for pipeline, group, offsets, groups in self._rows:
                if pipeline is not None:
                    set_pipeline(handle, pipeline)
                if group is not None:
                    set_group(handle, 0, group, len(offsets), offsets)
                dispatch(handle, *groups)
        commands.pipeline = self._last

    def _replay_slowly(self, encoder: Any) -> None:
        """By wgpu-py's own methods."""
        for pipeline, group, offsets, groups in self._rows:
            if pipeline is not None:
                encoder.set_pipeline(pipeline)
            if group is not None:
                encoder.set_bind_group(0, group, offsets)
            encoder.dispatch_workgroups(*groups)

    def release(self) -> None:
        """Let go of it all. What is encoded and not yet submitted keeps what it needs."""
        nbytes, self.nbytes = self.nbytes, 0
        self._gpu.memory.count(-nbytes)
        self._rows, self._kept, self._last, self.found = [], (), None, None

    def __del__(self) -> None:
        if self.nbytes:  # an error came before its release
            self._gpu.memory.count(-self.nbytes)


def _packed(dispatches: list[Dispatch]) -> tuple[dict[bytes, int], bytes]:
    """Where each of the parameters lies in a buffer, and what that holds."""
    places: dict[bytes, int] = {}
    data = bytearray()

    # Equal parameters lie in the buffer once.
    for value in (v for d in dispatches for v in d.values.values() if isinstance(v, Struct)):
        if value.data not in places:
            places[value.data] = len(data)
            data += value.data + bytes(-len(value.data) % _ALIGNMENT)
    return places, bytes(data)


def _row(pipeline: Any, group: Any, offsets: list[int], dispatch: Dispatch) -> _Row:
    if _CALLS is None:
        return pipeline, group, offsets, dispatch.groups

    # Handles of wgpu-native, and offsets as its calls take them.
    handles = [None if one is None else one._internal for one in (pipeline, group)]
    return handles[0], handles[1], ffi.new("uint32_t[]", offsets), dispatch.groups


_DISPATCH_CALLS = {
    "SetPipeline": ("Encoder", "Pipeline"),
    "SetBindGroup": ("Encoder", "uint32_t", "Group", "size_t", "uint32_t *"),
    "DispatchWorkgroups": ("Encoder", "uint32_t", "uint32_t", "uint32_t"),
}


def direct_calls(lib: Any, ffi: Any) -> tuple[Any, ...] | None:
    """The C functions that set a compute pass's pipeline and bind group and dispatch.

    wgpu-py wraps each, to raise what goes wrong in it at once; a pass tells when it ends, too. That
    is a tenth of the Python of a foggy frame with its 400 dispatches. None where the library has
    other ones.
    """
    # Calls are used only where their arguments are those that are known.
    found = []
    for name, wanted in _DISPATCH_CALLS.items():
        call = getattr(lib, f"wgpuComputePassEncoder{name}", None)
        try:
            given = [argument.cname for argument in ffi.typeof(call).args]
        except (TypeError, AttributeError):
            return None
        if len(given) != len(wanted) or not all(map(_is_like, given, wanted)):
            return None
        found.append(call)
    return tuple(found)


def _is_like(given: str, wanted: str) -> bool:
    return given == wanted or (wanted.isalpha() and wanted in given and given.endswith("*"))


_CALLS = direct_calls(lib, ffi)
