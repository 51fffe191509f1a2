"""Passes over the whole image: of each pixel a function, whatever runs it.

A CPU adapter draws a triangle over the image, whose flat interpolants are the parameters; a GPU
runs the same function as a compute pass, where targets can be stored: some have far more units
for those (an H100 computes on 132 multiprocessors and draws on 4).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .commands import Commands
from .counted import CountedRows
from .demands import fits
from .interpolants import MOST_WORDS, first_elements, interpolated
from .raster import RasterPipeline, Shader, color_attachments
from .source import compile_wgsl
from .stored import WORKGROUP, is_storable, stored, target_name

_VERTEX = """
//! use screen_corner
@vertex fn fullscreen(
    @builtin(vertex_index) index: u32, @builtin(instance_index) stripe: u32,
) -> @builtin(position) vec4f {
    return screen_corner(index, stripe);
}
"""


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

    def _shader(self, firsts: Mapping[str, tuple[str, ...]], text: str, generated: str) -> Shader:
        gpu, formats = self.gpu, self.targets_used
        # GPUs: a compute shader that stores pixels, where nothing is blended or tested.
        if gpu.paths.stored_screens and not (self.blend or self.depth):
            if is_storable(text, formats, generated):
                made = stored(self._slots, firsts, text, formats, generated)
                if fits(gpu, made.slots):
                    return made
        elif gpu.paths.flat_interpolants:
            # CPU adapters: what is the same for all pixels comes as flat interpolants.
            most = 4 * gpu.limits.get("max-inter-stage-shader-variables", MOST_WORDS // 4)
            made = interpolated(self._slots, firsts, text, most)
            if made.entry != "fragment":
                return made
        # Else a triangle over the image, whose fragments read their parameters themselves.
        before = _VERTEX + first_elements(self._slots, firsts)
        return Shader(self._slots, before, text, "fragment")

    def _compiled(self) -> Any:
        if self.stage != "compute":
            return super()._compiled()

        # No vertex stage: the entry is a compute shader.
        device = self.gpu.device
        module = compile_wgsl(device, self._source, self.label)
        layout = device.create_pipeline_layout(
            label=self.label, bind_group_layouts=[self.bindings.layout]
        )
        stage = {"module": module, "entry_point": self._entry, "constants": self._constants}
        return device.create_compute_pipeline(label=self.label, layout=layout, compute=stage)

    def draw(self, commands: Commands, targets: tuple[Any, ...], **values: Any) -> None:
        """Write `targets` (textures, or views); `values` name every slot."""
        self._draw(commands, targets, None, values)

    def draw_rows(
        self,
        commands: Commands,
        targets: tuple[Any, ...],
        rows: CountedRows | None,
        **values: Any,
    ) -> None:
        """The same, of as many rows as the device has counted; what is below is no image."""
        if rows is None:
            self._draw(commands, targets, None, values)
            return
        if self.stage == "compute":
            self._store(commands, targets, values, rows)
            return
        if commands.tally is not None:
            commands.tally.bound(commands.stage_name, targets)
        # The targets are cleared whole; how many pixels are drawn the device knows.
        colors = color_attachments(targets)
        with commands.render(self.label, color_attachments=colors) as encoder:
            encoder.set_pipeline(self.pipeline)
            self.bindings.bind(commands, encoder, 0, values)
            rows.draw(encoder)

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
        if self.stage == "compute":
            self._store(commands, targets, values)
            return
        if commands.tally is not None:
            width, height = getattr(targets[0], "size", (0, 0))[:2]
            commands.tally.ran(commands.stage_name, width * height)
            commands.tally.bound(commands.stage_name, targets)
        # A surface's view has no size, and is drawn whole.
        size = tuple(getattr(targets[0], "size", ()))[:2]
        rows = commands.bands((self, size), size[1]) if size else iter([(0, 0)])
        for first, count in rows:
            self._draw_rows(commands, targets, tested, values, (size, first, count))

    def _draw_rows(
        self,
        commands: Commands,
        targets: tuple[Any, ...],
        tested: DepthTest | None,
        values: dict[str, Any],
        band: tuple[tuple[int, ...], int, int],
    ) -> None:
        """Of targets of a size, which the first `band` clears, so many rows from one on."""
        # The first band clears the targets; later ones, and what is blended, keep what is there.
        size, first, count = band
        kept = len(targets) if first else self._blended
        colors = color_attachments(targets[:kept], keep=True) + color_attachments(targets[kept:])
        attached = tested.attached if tested else {}
        # Three vertices cover the target; a depth test leaves out pixels by what they hold.
        with commands.render(self.label, color_attachments=colors, **attached) as encoder:
            if tested:
                encoder.set_viewport(0, 0, *tested.size[:2], tested.at, tested.at)
            if size and count < size[1]:
                encoder.set_scissor_rect(0, first, size[0], count)
            encoder.set_pipeline(self.pipeline)
            self.bindings.bind(commands, encoder, 0, values)
            encoder.draw(3)

    def _store(
        self,
        commands: Commands,
        targets: tuple[Any, ...],
        values: dict[str, Any],
        rows: CountedRows | None = None,
    ) -> None:
        """The same as a compute pass."""
        width, height = targets[0].size[:2]
        bound = {target_name(k): target for k, target in enumerate(targets)}

        # Targets are bound behind the slots, as images.
        encoder = commands.compute_by(self.pipeline)
        self.bindings.bind(commands, encoder, 0, values | bound)
        if rows:
            encoder.dispatch_workgroups_indirect(rows.arguments.handle, 0)
        else:
            encoder.dispatch_workgroups(-(-width // WORKGROUP[0]), -(-height // WORKGROUP[1]))

        # Targets were counted where they were bound.
        if commands.tally is not None:
            commands.tally.ran(commands.stage_name, width * height)
