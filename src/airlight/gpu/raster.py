"""Render passes over meshes with vertex buffers; see fullscreen for those over whole images."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

from .bindings import Bindings
from .compute import shader_path
from .demands import check_slots, check_targets, compiled
from .device import Gpu
from .slots import Slot, declarations, on_device
from .source import Source, compile_wgsl


@dataclass(frozen=True)
class Shader:
    """What a pass is compiled from: slots, WGSL before its file, the file's, and where it begins.

    `stage`: what runs the pass at each pixel.
    """

    slots: tuple[Slot, ...]
    generated: str
    text: str
    entry: str
    stage: Literal["fragment", "compute"] = "fragment"


class RasterPipeline:
    """A render pipeline with up to two bind groups: the pass's own and a second, per material."""

    slots: tuple[Slot, ...]
    second_slots: ClassVar[tuple[Slot, ...]] = ()
    targets: tuple[str, ...] = ()
    depth: ClassVar[str] = ""
    depth_compare: ClassVar[str] = "greater"
    depth_writes: ClassVar[bool] = True
    vertex_buffers: ClassVar[tuple[dict[str, Any], ...]] = ()
    vertex_entry: ClassVar[str] = "vertex"
    fragment_entry: ClassVar[str] = "fragment"
    topology: ClassVar[str] = "triangle-list"
    blend: ClassVar[dict[str, Any] | None] = None
    blended: ClassVar[int | None] = None  # so many of the targets, the first; all if not given
    file: ClassVar[str] = ""

    def __init__(
        self,
        gpu: Gpu,
        *,
        constants: dict[str, float] | None = None,
        cull: str = "none",
        front_face: str = "ccw",
        generated: str = "",
        targets: tuple[str, ...] | None = None,
        firsts: Mapping[str, tuple[str, ...]] | None = None,
    ) -> None:
        """`firsts`: storage buffers of which the pass reads `first_NAME()`, and not these fields.

        In full-screen passes, for which CPU adapters have them at hand; as are uniforms.
        """
        self.gpu, self.label = gpu, type(self).__name__
        self._slots, self._second = (
            on_device(slots, gpu) for slots in (self.slots, self.second_slots)
        )
        self.targets_used = self.targets if targets is None else targets

        # What the device cannot bind or draw to is refused before anything is made of it.
        check_slots(gpu, self.label, (*self._slots, *self._second))
        check_targets(gpu, self.label, self.targets_used)
        # The source, and what is generated for it.
        made = self._shader(firsts or {}, shader_path(type(self)).read_text(), generated)
        self._slots, self._entry = made.slots, made.entry
        self._source = self._joined(made.generated + generated, made.text)
        self._constants = constants or {}
        # Bind groups: the pass's own, and one per material.
        self.stage = made.stage
        is_compute = made.stage == "compute"
        self.bindings = Bindings(gpu, self._slots, compute=is_compute, label=self.label)
        self.second: Bindings | None = None
        if self.second_slots:
            self.second = Bindings(gpu, self._second, compute=False, label=f"{self.label} material")
        self._primitive = {"topology": self.topology, "cull_mode": cull, "front_face": front_face}
        layouts = [slot.layout for slot in (*self._slots, *self._second)]
        # All that a compiled pipeline is shared by, beside its source.
        self._made_of = (
            self.label,
            constants,
            self._primitive,
            self._depth_state(),
            self.targets_used,
            self.blend,
            self.blended,
            self.vertex_buffers,
            self.vertex_entry,
            self._entry,
            layouts,
        )

    @cached_property
    def pipeline(self) -> Any:
        """Compiled when the pass first runs. Raises ShaderError, DeviceError."""
        return self.gpu.pipelines.get(
            self._source.text,
            self._made_of,
            lambda: compiled(self.gpu, self.label, self._compiled),
        )

    def _compiled(self) -> Any:
        device = self.gpu.device
        module = compile_wgsl(device, self._source, self.label)
        # The bindings of the pass, and those of each draw.
        groups = [b.layout for b in (self.bindings, self.second) if b]
        vertex = {
            "module": module,
            "entry_point": self.vertex_entry,
            "constants": self._constants,
            "buffers": list(self.vertex_buffers),
        }
        return device.create_render_pipeline(
            label=self.label,
            layout=device.create_pipeline_layout(label=self.label, bind_group_layouts=groups),
            vertex=vertex,
            primitive=self._primitive,
            depth_stencil=self._depth_state(),
            fragment=self._fragment_state(module),
        )

    def _shader(self, firsts: Mapping[str, tuple[str, ...]], text: str, generated: str) -> Shader:
        return Shader(self._slots, "", text, self.fragment_entry)

    def _joined(self, generated: str, text: str) -> Source:
        source = Source()

        # Bindings first, then what is generated from them, then the pass's own file.
        source.add(declarations(self._slots), f"{self.label} slots")
        if self.second_slots:
            source.add(declarations(self._second, 1), f"{self.label} material slots")
        if generated:
            source.add(generated, f"{self.label} generated")
        path = shader_path(type(self))
        source.add(text, f"{path.parent.name}/{path.name}")
        return source

    def _depth_state(self) -> dict[str, Any] | None:
        if not self.depth:
            return None
        return {
            "format": self.depth,
            "depth_write_enabled": self.depth_writes,
            "depth_compare": self.depth_compare,
        }

    def _fragment_state(self, module: Any) -> dict[str, Any] | None:
        if not self.fragment_entry:
            return None
        extra = {"blend": self.blend} if self.blend else {}

        # Only the first targets may be blended.
        extras = [extra if i < self._blended else {} for i in range(len(self.targets_used))]
        return {
            "module": module,
            "entry_point": self._entry,
            "constants": self._constants,
            "targets": [{"format": f, **e} for f, e in zip(self.targets_used, extras, strict=True)],
        }

    @property
    def _blended(self) -> int:
        """How many targets are blended with."""
        every = len(self.targets_used) if self.blend else 0
        return every if self.blended is None else min(self.blended, every)


def color_attachments(targets: tuple[Any, ...], *, keep: bool = False) -> list[dict[str, Any]]:
    """`targets` (textures, or views) as a render pass takes them; `keep` what is in them."""
    return [
        {
            "view": getattr(t, "resource", t),
            "load_op": "load" if keep else "clear",
            "store_op": "store",
            "clear_value": (0, 0, 0, 0),
        }
        for t in targets
    ]


def depth_attachment(target: Any, far: float, *, keep: bool = False) -> dict[str, Any]:
    """A depth texture, or a view, as a render pass takes it: cleared to `far`, unless `keep`."""
    return {
        "view": getattr(target, "resource", target),
        "depth_load_op": "load" if keep else "clear",
        "depth_store_op": "store",
        "depth_clear_value": far,
    }
