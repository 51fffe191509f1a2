"""The G-buffer: depth, base colour, normal, emission and the material's parameters."""

from __future__ import annotations

from typing import Any, ClassVar

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f
from ..gpu.memory import Texture
from ..gpu.raster import color_attachments, depth_attachment
from ..gpu.slots import uniform
from ..maths.transforms import F64
from .draw_parts import DrawParts, in_draw_order
from .draws import Draw
from .geometry import GpuScene
from .mesh_pass import MESH_SLOTS, DepthPipeline, MeshPass, MeshPipeline
from .packed_maps import uses_visibility_buffer
from .visibility_buffer import VisibilityBuffer, VisibilityParams

DEPTH_FIRST_PX = 0.8
"""Pixels per triangle in sight from which on depth is drawn first: triangles twice, pixels once.

GPUs alone ask: CPU adapters draw `surface.visibility_buffer`."""


class CameraParams(Struct):
    """The camera's matrix, and what an unlit surface of base colour 1 sends to it."""

    clip_from_world = mat4x4f()
    unlit_radiance = f32("W m^-2 sr^-1")


class _Depth(DepthPipeline):
    slots = (uniform("params", CameraParams), *MESH_SLOTS)


class _Cutout(MeshPipeline):
    slots = _Depth.slots
    depth_compare = "greater-equal"  # of coincident surfaces the last drawn one is visible
    targets = ("rgba16float", "rgba16float", "rgba16float")
    file = "gbuffer.wgsl"


class _Opaque(_Cutout):
    """Materials without holes, after depth was drawn: no pixel is shaded twice."""

    depth_compare, depth_writes = "equal", False


class GBuffer:
    """Textures of the image's size; depth is reversed and infinite, 0 in the background.

    albedo   rgb base colour, a metallic
    normal   xyz world, facing the camera; w roughness
    emission rgb W m^-2 sr^-1, a specular
    """

    has_triangle_ids: ClassVar[bool] = True
    """Whether CPU adapters draw the visibility buffer instead."""

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        # Surfaces in one pass, or after depth, which leaves hidden pixels unshaded.
        self._depth_pass = MeshPass(gpu, _Depth, culls=True)
        self._only_pass = MeshPass(gpu, _Cutout, culls=True)
        self._pass = MeshPass(gpu, _Cutout, opaque=_Opaque, culls=True)
        self._sized = gpu.scope()

        # CPU adapters draw triangle ids, and surfaces from them.
        self._visibility: VisibilityBuffer | None = None
        if self.has_triangle_ids and uses_visibility_buffer(gpu):
            self._visibility = VisibilityBuffer(gpu, size)
        self._parts = DrawParts(self._split)
        self.unlit_radiance = 1.0
        self._key: tuple[GpuScene, int, bytes, float] | None = None  # of what the textures hold
        self._make_textures(size)

    def _make_textures(self, size: tuple[int, int]) -> None:
        self.size, gpu = size, self._sized
        self.depth = Texture(gpu, "depth", size, "depth32float", target=True)
        self.albedo = Texture(gpu, "albedo", size, "rgba16float", target=True)
        self.normal = Texture(gpu, "normal", size, "rgba16float", target=True)
        self.emission = Texture(gpu, "emission", size, "rgba16float", target=True)
        self._targets = (self.albedo, self.normal, self.emission)

    @property
    def bound(self) -> dict[str, Any]:
        """By slot name, for lighting passes."""
        return {
            "depth": self.depth,
            "albedo": self.albedo,
            "normal": self.normal,
            "emission": self.emission,
        }

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on."""
        self._sized.release()
        self._parts, self._key = DrawParts(self._split), None
        self._make_textures(size)
        if self._visibility:
            self._visibility.resize(size)

    def encode(self, commands: Commands, scene: GpuScene, clip_from_world: F64) -> None:
        """Rasterise the scene through `clip_from_world`; cached while neither changes."""
        key = (scene, scene.version, clip_from_world.tobytes(), self.unlit_radiance)
        if key == self._key:
            return
        self._key = None  # until all is drawn: after an error nothing counts as drawn
        self._rasterise(commands, scene, clip_from_world)
        self._key = key

    def _rasterise(self, commands: Commands, scene: GpuScene, clip_from_world: F64) -> None:
        # What is seen, and whether its depth is drawn first.
        draws = scene.solid(clip_from_world)
        first, then, is_depth_first = self._parts.of(scene, draws)
        cleared = depth_attachment(self.depth, 0.0)
        params = CameraParams(clip_from_world=clip_from_world, unlit_radiance=self.unlit_radiance)
        # Triangle ids first, which a full-screen pass turns into surfaces.
        if self._visibility:
            inv_size = (1.0 / self.size[0], 1.0 / self.size[1])
            visibility = VisibilityParams(clip_from_world=clip_from_world, inv_size=inv_size)

            # One of the two clears the targets, even where nothing is drawn.
            if first or not then:
                self._visibility.encode(
                    commands, scene, first, clip_from_world, cleared, self._targets, visibility
                )
            if then:
                keep = bool(first)
                self._draw(commands, scene, then, params, keeps_depth=keep, keeps_colors=keep)
            return
        # Or surfaces by rasterisation alone.
        if is_depth_first:
            with commands.render(
                "depth", color_attachments=[], depth_stencil_attachment=cleared
            ) as encoder:
                self._depth_pass.draw(commands, encoder, scene, first, params)
        self._draw(commands, scene, then, params, keeps_depth=is_depth_first)

    def _split(self, scene: GpuScene, draws: list[Draw]) -> tuple[list[Draw], list[Draw], bool]:
        """The draws of the first pass, those of the second, and whether the first is depth only."""
        if self._visibility:
            return *self._visibility.split(scene, draws), False

        # Depth first pays off where pixels are many beside triangles.
        triangles = sum(draw.index_count * draw.instance_count for draw in draws) / 3
        is_depth_first = self.size[0] * self.size[1] >= DEPTH_FIRST_PX * triangles
        opaque = [draw for draw in draws if draw.material.alpha_cutoff <= 0.0]
        return opaque, in_draw_order(scene, draws), is_depth_first

    def _draw(
        self,
        commands: Commands,
        scene: GpuScene,
        draws: list[Draw],
        params: CameraParams,
        *,
        keeps_depth: bool,
        keeps_colors: bool = False,
    ) -> None:
        # Where only depth was drawn before, it says which surfaces to shade.
        used = self._pass if keeps_depth and not keeps_colors else self._only_pass
        with commands.render(
            "g-buffer",
            color_attachments=color_attachments(self._targets, keep=keeps_colors),
            depth_stencil_attachment=depth_attachment(self.depth, 0.0, keep=keeps_depth),
        ) as encoder:
            used.draw(commands, encoder, scene, draws, params)
