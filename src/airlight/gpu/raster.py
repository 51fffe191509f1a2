"""Render passes: over meshes with vertex buffers, or over the whole image."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

from .bindings import Bindings
from .commands import Commands
from .compute import shader_path
from .demands import check_slots, check_targets, compiled
from .device import Gpu
from .interpolants import MOST_WORDS, Interpolated, first_elements, interpolated
from .slots import Slot, declarations, on_device
from .source import Source, compile_wgsl

_FULLSCREEN_VERTEX = """
@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}
"""


class RasterPipeline:
    """A render pipeline with up to two bind groups: the pass's own and a second, per material."""

    slots: ClassVar[tuple[Slot, ...]]
    second_slots: ClassVar[tuple[Slot, ...]] = ()
    targets: ClassVar[tuple[str, ...]] = ()
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
        check_slots(gpu, self.label, (*self._slots, *self._second))
        check_targets(gpu, self.label, self.targets_used)
        # The source; full-screen passes bring the vertex shader, and parameters where that pays.
        text = shader_path(type(self)).read_text()
        self._entry = self.fragment_entry
        if self.vertex_entry == "fullscreen":
            made = self._fullscreen(firsts or {}, text)
            self._slots, self._entry, text = made.slots, made.entry, made.text
            generated = made.generated + generated
        self._source, self._constants = self._joined(generated, text), constants or {}
        # Bind groups: the pass's own, and one per material.
        self.bindings = Bindings(gpu, self._slots, compute=False, label=self.label)
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

    def _fullscreen(self, firsts: Mapping[str, tuple[str, ...]], text: str) -> Interpolated:
        if self.gpu.paths.flat_interpolants:
            most = 4 * self.gpu.limits.get("max-inter-stage-shader-variables", MOST_WORDS // 4)
            made = interpolated(self._slots, firsts, text, most)
            if made.entry != "fragment":
                return made
        return Interpolated(
            self._slots, _FULLSCREEN_VERTEX + first_elements(self._slots, firsts), text, "fragment"
        )

    def _joined(self, generated: str, text: str) -> Source:
        source = Source()
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


@dataclass(frozen=True, eq=False)
class DepthTest:
    """What the pixels of a full-screen pass are tested against: as if they all lay `at` a depth.

    A CPU adapter leaves out the blocks of pixels that fail; it would run both sides of a branch.
    """

    view: Any
    size: tuple[int, ...]
    at: float

    @property
    def attached(self) -> dict[str, Any]:
        """As a render pass takes it."""
        return {"depth_stencil_attachment": {"view": self.view, "depth_read_only": True}}


class FullscreenPass(RasterPipeline):
    """A fragment shader over every pixel of its targets, or over those that a depth test leaves."""

    vertex_entry = "fullscreen"
    depth_writes = False

    def draw(self, commands: Commands, targets: tuple[Any, ...], **values: Any) -> None:
        """Write `targets` (textures, or views); `values` name every slot."""
        self._draw(commands, targets, None, values)

    def draw_where(
        self, commands: Commands, targets: tuple[Any, ...], passed: DepthTest, **values: Any
    ) -> None:
        """The same where a test is `passed`; zero elsewhere."""
        self._draw(commands, targets, passed, values)

    def _draw(
        self,
        commands: Commands,
        targets: tuple[Any, ...],
        tested: DepthTest | None,
        values: dict[str, Any],
    ) -> None:
        kept = self._blended
        colors = color_attachments(targets[:kept], keep=True) + color_attachments(targets[kept:])
        if commands.tally is not None:
            width, height = getattr(targets[0], "size", (0, 0))[:2]
            commands.tally.ran(commands.stage_name, width * height)
            commands.tally.bound(commands.stage_name, targets)
        attached = tested.attached if tested else {}
        # Three vertices cover the target; a depth test leaves out pixels by what they hold.
        with commands.render(self.label, color_attachments=colors, **attached) as encoder:
            if tested:
                encoder.set_viewport(0, 0, *tested.size[:2], tested.at, tested.at)
            encoder.set_pipeline(self.pipeline)
            self.bindings.bind(commands, encoder, 0, values)
            encoder.draw(3)


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
