"""A compute pass: one Python class and the WGSL file beside it.

The WGSL holds functions and `@compute @workgroup_size(WX, WY, WZ) fn main`; structs, bindings
and the workgroup constants WX, WY, WZ are generated from the class.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Any, ClassVar

from .bands import BAND, Band, banded, longest, part
from .bands import ENTRY as BANDED
from .bindings import Bindings
from .commands import Commands
from .counted import CountedRows
from .demands import check_slots, check_workgroup, compiled
from .device import Gpu
from .memory import Buffer
from .recorded import Dispatch
from .slots import Slot, declarations, on_device
from .source import Source, compile_wgsl

_GRIDS_KEPT = 64


class ComputePass:
    """A compute pass: subclasses give `slots`, `workgroup`, and a `.wgsl` of the module's name."""

    slots: tuple[Slot, ...]
    """What it binds: of the class, or of the object, set before this class begins it."""
    workgroup: ClassVar[tuple[int, int, int]] = (8, 8, 1)
    entry: ClassVar[str] = "main"
    file: ClassVar[str] = ""
    in_bands: ClassVar[bool] = False
    """Whether it may take long, and workgroups need not run together: it is divided (see bands)."""

    def __init__(
        self, gpu: Gpu, *, constants: dict[str, float] | None = None, generated: str = ""
    ) -> None:
        """`constants` set the shader's `override`s; `generated` WGSL goes before the file's."""
        self.gpu, self.label = gpu, type(self).__name__
        self._groups: dict[tuple[int, ...], tuple[int, ...]] = {}
        self._source, self._constants = Source(), constants or {}
        source = self._source
        wx, wy, wz = self.workgroup
        # What the device cannot bind or run is refused before anything is made of it.
        slots = on_device((*self.slots, BAND) if self.in_bands else self.slots, gpu)
        check_slots(gpu, self.label, slots)
        check_workgroup(gpu, self.label, self.workgroup)
        # The whole source: bindings and workgroup from the class, what is generated, then the
        # file.
        source.add(declarations(slots), f"{self.label} slots")
        source.add(f"const WX = {wx}u;\nconst WY = {wy}u;\nconst WZ = {wz}u;", "workgroup")
        if generated:
            source.add(generated, f"{self.label} generated")
        path = shader_path(type(self))
        text = path.read_text()
        # In bands another entry runs, which adds what lies before the band to the shader's ids.
        if self.in_bands:
            text, entry = banded(text)
            source.add(entry, f"{self.label} bands")
        source.add(text, f"{path.parent.name}/{path.name}")
        self._begins = BANDED if self.in_bands else self.entry
        self.bindings = Bindings(gpu, slots, compute=True, label=self.label)
        self._made_of = (self.label, self._begins, constants, [slot.layout for slot in slots])

    @cached_property
    def pipeline(self) -> Any:
        """The pipeline, compiled when the pass first runs. Raises ShaderError, DeviceError."""
        return self.gpu.pipelines.get(*self._wanted)

    def begin(self) -> None:
        """Start compiling in another thread: for kernels that take a driver seconds."""
        self.gpu.pipelines.begin(*self._wanted)

    @property
    def _wanted(self) -> tuple[str, Any, Callable[[], Any]]:
        """Text, parts and maker of the pipeline, as `Pipelines.get` takes them."""
        return (
            self._source.text,
            self._made_of,
            lambda: compiled(self.gpu, self.label, self._compiled),
        )

    def _compiled(self) -> Any:
        device = self.gpu.device
        module = compile_wgsl(device, self._source, self.label)
        layout = device.create_pipeline_layout(
            label=self.label, bind_group_layouts=[self.bindings.layout]
        )
        stage = {"module": module, "entry_point": self._begins, "constants": self._constants}
        return device.create_compute_pipeline(label=self.label, layout=layout, compute=stage)

    def dispatch(self, commands: Commands, invocations: tuple[int, ...], **values: Any) -> None:
        """Run over a grid of `invocations` (x, y, z); `values` name every slot."""
        # Grids are grouped once for each size; most passes then are one dispatch.
        groups = self._groups.get(invocations) or self._grouped(invocations)
        if not self.in_bands:
            self._dispatch(commands, groups, values)
            return
        # Band by band along the longest axes; in a frame there is one.
        layers, rows = (groups[axis] for axis in longest(groups))
        for first, count in commands.bands((self, groups), layers * rows, rows):
            begin, size = part(groups, first, count)
            self._dispatch(commands, size, values | {"band": Band.of(first=begin, pad=0)})

    def _dispatch(
        self, commands: Commands, groups: tuple[int, ...], values: dict[str, Any]
    ) -> None:
        self._ready(commands, values).dispatch_workgroups(*groups)
        if commands.tally is not None:
            commands.tally.ran(commands.stage_name, prod(groups) * prod(self.workgroup))
        if commands.recording is not None:
            commands.recording.append(Dispatch(self.pipeline, self.bindings, values, groups))

    def dispatch_rows(
        self,
        commands: Commands,
        invocations: tuple[int, ...],
        rows: CountedRows | None,
        **values: Any,
    ) -> None:
        """Run over a grid, or over as many of its `rows` as the device has counted."""
        if rows is None:
            self.dispatch(commands, invocations, **values)
        else:
            self.dispatch_indirect(commands, rows.arguments, **values)

    def dispatch_indirect(self, commands: Commands, groups: Buffer, **values: Any) -> None:
        """Run as many groups as the first three numbers of `groups` say, on the device."""
        if commands.recording is not None:
            raise RuntimeError(f"{self.label}: what runs by numbers of the device is not recorded")
        if self.in_bands:
            values = values | {"band": Band.of(first=(0, 0, 0), pad=0)}
        self._ready(commands, values).dispatch_workgroups_indirect(groups.handle, 0)

    def _ready(self, commands: Commands, values: dict[str, Any]) -> Any:
        """The open compute pass with this pass's pipeline and bindings."""
        commands.make_room()
        encoder = commands.compute_by(self.pipeline)
        self.bindings.bind(commands, encoder, 0, values)
        return encoder

    def _grouped(self, invocations: tuple[int, ...]) -> tuple[int, ...]:
        """Workgroups for a grid of `invocations`. Raises DeviceError for too many."""
        # Whole workgroups around the grid; shaders leave out what lies beyond it.
        counts = (*invocations, 1, 1)[:3]
        groups = tuple(-(-n // w) for n, w in zip(counts, self.workgroup, strict=True))
        self.gpu.require(
            "max-compute-workgroups-per-dimension", max(groups), f"pass '{self.label}'"
        )
        if len(self._groups) >= _GRIDS_KEPT:
            self._groups.clear()
        self._groups[invocations] = groups
        return groups


def shader_path(cls: type) -> Path:
    """The `.wgsl` beside the class's module: its `file`, or the module's own stem."""
    module = Path(inspect.getfile(cls))
    name = getattr(cls, "file", "")
    return module.parent / name if name else module.with_suffix(".wgsl")
