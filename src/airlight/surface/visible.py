"""Surfaces drawn in two steps: which triangle each pixel sees, then each pixel's surface once.

Burns2013 call the picture of the first step a visibility buffer. Software drivers shade whole
blocks of pixels for every triangle that touches them, three to four times as many pixels as there
are where triangles are small; which triangle it is costs them next to nothing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, mat4x4f, vec2f
from ..gpu.memory import Buffer, Texture
from ..gpu.raster import FullscreenPass
from ..gpu.slots import Slot, storage, texture, uniform
from ..maths.transforms import F64
from .draw_parts import later_last
from .geometry import Draw, GpuScene
from .mesh_pass import (
    INSTANCE_PLACES,
    MATERIAL_SLOTS,
    MESH_SLOTS,
    VERTEX_BUFFERS,
    MeshPass,
    MeshPipeline,
)
from .seen_triangles import SeenInstance


class VisibleParams(Struct):
    """Where the camera is."""

    clip_from_world = mat4x4f()


class SeenParams(Struct):
    """Where the camera is, and how wide pixels are."""

    clip_from_world = mat4x4f()
    inv_size = vec2f("of the picture, px^-1")


_WHAT: dict[str, Any] = {
    "array_stride": SeenInstance.dtype.itemsize,
    "step_mode": "instance",
    "attributes": [
        {"shader_location": 8, "offset": 0, "format": "uint32"},
        {"shader_location": 9, "offset": 4, "format": "uint32"},
    ],
}
_UV: dict[str, Any] = {
    "array_stride": 8,
    "step_mode": "vertex",
    "attributes": [{"shader_location": 1, "offset": 0, "format": "float32x2"}],
}


class _Visible(MeshPipeline):
    slots: ClassVar[tuple[Slot, ...]] = (uniform("params", VisibleParams), *MESH_SLOTS)
    second_slots: ClassVar[tuple[Slot, ...]] = ()
    vertex_buffers: ClassVar[tuple[dict[str, Any], ...]] = (
        VERTEX_BUFFERS[0],
        INSTANCE_PLACES,
        _WHAT,
    )
    # Of two surfaces in one place the later one is seen: see `later_last`.
    depth_compare = "greater-equal"
    targets = ("rg32uint",)
    maps: ClassVar[tuple[str, ...]] = ()
    file = "visible.wgsl"

    def vertices_of(self, scene: GpuScene) -> tuple[Buffer, ...]:
        """Vertices that tell triangles apart, where instances are, and what."""
        return (scene.seen.positions, scene.instances, scene.seen.instances)

    def indices_of(self, scene: GpuScene) -> Buffer:
        """Into those vertices."""
        return scene.seen.indices


class _VisibleCutout(_Visible):
    second_slots = MATERIAL_SLOTS
    vertex_buffers = (*_Visible.vertex_buffers, _UV)
    maps = ("base_color",)
    file = "visible_cutout.wgsl"

    def vertices_of(self, scene: GpuScene) -> tuple[Buffer, ...]:
        """Those, and where the maps lie on them."""
        return (*super().vertices_of(scene), scene.seen.uvs)


class _VisibleToLight(_Visible):
    depth_compare = "less-equal"


class _CutoutToLight(_VisibleCutout):
    depth_compare = "less-equal"


SEEN_SLOTS = (
    texture("visible", "2d", "uint"),
    storage("triangles", "vec2<u64>"),
    storage("instances", "vec2<u64>"),
    storage("materials", "vec4<u64>"),
    storage("placements", "vec4f"),
    storage("texels", "u64"),
)
"""What a pass with `//! use seen_surface` binds beside its `params`."""


class SeenGBuffer(FullscreenPass):
    """The G-buffer of what pixels see; its params are SeenParams."""

    slots = (uniform("params", SeenParams), *SEEN_SLOTS)
    targets = ("rgba16float", "rgba16float", "rgba16float")
    file = "visible_surface.wgsl"


class VisibleSurfaces:
    """The two steps for pictures of one size, of a camera (depth reversed) or of lights."""

    def __init__(
        self,
        gpu: Gpu,
        size: tuple[int, int],
        surface: type[FullscreenPass] = SeenGBuffer,
        *,
        of_lights: bool = False,
    ) -> None:
        """`surface` is the second step: a pass with SEEN_SLOTS."""
        self.gpu, self._surface = gpu, surface
        kinds = (_CutoutToLight, _VisibleToLight) if of_lights else (_VisibleCutout, _Visible)
        self._pass = MeshPass(gpu, kinds[0], opaque=kinds[1])
        self._surfaces: dict[bool, FullscreenPass] = {}
        self._take(size)

    def _take(self, size: tuple[int, int]) -> None:
        self.seen = Texture(self.gpu, "visible", size, "rg32uint", target=True)

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels."""
        self.release()
        self._take(size)

    @staticmethod
    def split(scene: GpuScene, draws: list[Draw]) -> tuple[list[Draw], list[Draw]]:
        """The draws that can be drawn this way, for `encode`, and the rest, to be drawn over them.

        Those alone that did not fit into memory are out of the order of `later_last`.
        """
        shown = [scene.seen.shows(draw.base_vertex, draw.material) for draw in draws]
        rest = [draw for draw, is_shown in zip(draws, shown, strict=True) if not is_shown]
        seen = scene.seen
        return (
            [
                replace(
                    draw,
                    base_vertex=seen.base_vertex[draw.base_vertex],
                    first_index=seen.first_index[draw.base_vertex],
                )
                for draw, is_shown in zip(draws, shown, strict=True)
                if is_shown
            ],
            later_last(scene, rest),
        )

    def encode(
        self,
        commands: Commands,
        scene: GpuScene,
        draws: list[Draw],
        clip_from_world: F64,
        depth: dict[str, Any],
        targets: tuple[Any, ...],
        params: Struct,
    ) -> None:
        """Fill all of `targets` and the attachment `depth`; zeros where none of `draws` is.

        `params` are those of the second step.
        """
        color = {
            "view": self.seen.resource,
            "load_op": "clear",
            "store_op": "store",
            "clear_value": (0, 0, 0, 0),
        }
        with commands.render(
            "visible", color_attachments=[color], depth_stencil_attachment=depth
        ) as encoder:
            self._pass.draw(
                commands, encoder, scene, draws, VisibleParams(clip_from_world=clip_from_world)
            )
        seen, is_placed = scene.seen, scene.seen.has_placed_maps
        if is_placed not in self._surfaces:
            constants = {"HAS_PLACED_MAPS": float(is_placed)}
            self._surfaces[is_placed] = self._surface(self.gpu, constants=constants)
        self._surfaces[is_placed].draw(
            commands,
            targets,
            params=params,
            visible=self.seen,
            triangles=seen.triangles,
            instances=scene.instances,
            materials=seen.materials,
            placements=seen.placements,
            texels=seen.texels,
        )

    def release(self) -> None:
        """Give the memory back."""
        self.seen.release()
