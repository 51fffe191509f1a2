"""The visibility buffer (Burns2013): triangle ids per pixel, then each pixel's surface once.

CPU adapters shade whole blocks of pixels for every triangle that touches them: where triangles are
small, three to four times as many pixels as the image has. Writing a triangle id costs them next to
nothing, and the second pass shades each pixel once.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import DepthTest, FullscreenPass
from ..gpu.layout import Struct, mat4x4f, vec2f
from ..gpu.memory import Buffer, Texture
from ..gpu.raster import color_attachments
from ..gpu.slots import Slot, storage, texture, uniform
from ..maths.transforms import F64
from .draw_parts import in_draw_order
from .draws import Draw
from .geometry import GpuScene
from .mesh_pass import (
    INSTANCE_TRANSFORMS,
    MATERIAL_SLOTS,
    MESH_SLOTS,
    VERTEX_BUFFERS,
    MeshPass,
    MeshPipeline,
    ViewParams,
)
from .triangle_table import InstanceIds


class VisibilityParams(Struct):
    """The camera's matrix and the width of pixels."""

    clip_from_world = mat4x4f()
    inv_size = vec2f("of the image, px^-1")


_WHAT: dict[str, Any] = {
    "array_stride": InstanceIds.dtype.itemsize,
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


class _TriangleIds(MeshPipeline):
    slots = (uniform("params", ViewParams), *MESH_SLOTS)
    second_slots: ClassVar[tuple[Slot, ...]] = ()
    vertex_buffers: ClassVar[tuple[dict[str, Any], ...]] = (
        VERTEX_BUFFERS[0],
        INSTANCE_TRANSFORMS,
        _WHAT,
    )
    vertices = ""
    # Of coincident surfaces the last drawn one is visible: see `in_draw_order`.
    depth_compare = "greater-equal"
    targets = ("rg32uint",)
    maps: ClassVar[tuple[str, ...]] = ()
    file = "visibility_ids.wgsl"

    def vertices_of(self, scene: GpuScene) -> tuple[Buffer, ...]:
        """Vertices with unique first corners, transforms, and ids of instances."""
        table = scene.triangle_table
        return (table.shared.positions, scene.instances, table.instances)

    def indices_of(self, scene: GpuScene) -> Buffer:
        """Into those vertices."""
        return scene.triangle_table.shared.indices


class _CutoutTriangleIds(_TriangleIds):
    second_slots = MATERIAL_SLOTS
    vertex_buffers = (*_TriangleIds.vertex_buffers, _UV)
    maps = ("base_color",)
    file = "visibility_ids_cutout.wgsl"

    def vertices_of(self, scene: GpuScene) -> tuple[Buffer, ...]:
        """The same, and texture coordinates."""
        return (*super().vertices_of(scene), scene.triangle_table.shared.uvs)


class _LightTriangleIds(_TriangleIds):
    depth_compare = "less-equal"


class _LightCutoutTriangleIds(_CutoutTriangleIds):
    depth_compare = "less-equal"


VISIBILITY_SLOTS = (
    texture("triangle_ids", "2d", "uint"),
    storage("triangles", "vec2<u64>"),
    storage("instances", "vec2<u64>"),
    storage("materials", "vec4<u64>"),
    storage("uv_transforms", "vec4f"),
    storage("texels", "u64"),
)
"""What a pass with `//! use visibility_surface` binds beside its `params`."""


class GBufferFromIds(FullscreenPass):
    """The G-buffer from triangle ids; its params are VisibilityParams."""

    depth, depth_compare = "depth32float", "less"  # where a triangle is nearer than the clear value

    slots = (uniform("params", VisibilityParams), *VISIBILITY_SLOTS)
    targets = ("rgba16float", "rgba16float", "rgba16float")
    file = "visibility_gbuffer.wgsl"


class VisibilityBuffer:
    """Both passes for images of one size, of a camera (reversed depth) or of lights."""

    def __init__(
        self,
        gpu: Gpu,
        size: tuple[int, int],
        surface: type[FullscreenPass] = GBufferFromIds,
        *,
        of_lights: bool = False,
    ) -> None:
        """`surface` is the second pass, with VISIBILITY_SLOTS; it tests against depth."""
        self.gpu, self._surface = gpu, surface

        # Lights see both sides of culled surfaces, cameras look through their backs.
        kinds = (
            (_LightCutoutTriangleIds, _LightTriangleIds)
            if of_lights
            else (_CutoutTriangleIds, _TriangleIds)
        )
        self._pass = MeshPass(gpu, kinds[0], opaque=kinds[1], culls=not of_lights)
        self._surfaces: dict[bool, FullscreenPass] = {}
        self._take(size)

    def _take(self, size: tuple[int, int]) -> None:
        self.triangle_ids = Texture(self.gpu, "triangle ids", size, "rg32uint", target=True)

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on."""
        self.triangle_ids.release()
        self._take(size)

    @staticmethod
    def split(scene: GpuScene, draws: list[Draw]) -> tuple[list[Draw], list[Draw]]:
        """The draws that the visibility buffer can show, and the rest, drawn after them.

        Draws that only did not fit into memory are not ordered as `in_draw_order` asks.
        """
        # What the table holds is drawn from it; all else as ever.
        table = scene.triangle_table
        shown = [table.shows(draw.base_vertex, draw.material) for draw in draws]
        rest = [draw for draw, is_shown in zip(draws, shown, strict=True) if not is_shown]

        # The table has vertices and indices of its own, for which draws exchange theirs.
        return (
            [
                replace(
                    draw,
                    base_vertex=table.shared.base_vertex[draw.base_vertex],
                    first_index=table.shared.first_index[draw.base_vertex],
                )
                for draw, is_shown in zip(draws, shown, strict=True)
                if is_shown
            ],
            in_draw_order(scene, rest),
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
        """Fill all `targets` and the attachment `depth`; zeros where none of `draws` is.

        `params` are those of the second pass.
        """
        # Which triangle each pixel sees.
        with commands.render(
            "triangle ids",
            color_attachments=color_attachments((self.triangle_ids,)),
            depth_stencil_attachment=depth,
        ) as encoder:
            view = ViewParams(clip_from_world=clip_from_world)
            self._pass.draw(commands, encoder, scene, draws, view)
        # What that triangle is there.
        table = scene.triangle_table

        # A pipeline with maps' transforms, or without: made when it is first needed.
        has_transforms = table.has_map_transforms
        if has_transforms not in self._surfaces:
            constants = {"HAS_MAP_TRANSFORM": float(has_transforms)}
            self._surfaces[has_transforms] = self._surface(self.gpu, constants=constants)
        self._surfaces[has_transforms].draw_where(
            commands,
            targets,
            DepthTest(depth["view"], self.triangle_ids.size, depth["depth_clear_value"]),
            params=params,
            triangle_ids=self.triangle_ids,
            triangles=table.shared.triangles,
            instances=scene.instances,
            materials=table.materials,
            uv_transforms=table.uv_transforms,
            texels=table.texels,
        )
