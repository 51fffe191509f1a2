"""Reflective shadow maps (Dachsbacher2005): depth, normal and reflected flux per light.

Each texel is a virtual point light (Kaplanyan2010 section 3.1). The flux is stored per texel
measure (m^2 for parallel light, sr in perspective), so that half floats hold it; its reader
multiplies by the measure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, f32, mat4x4f, pack_array, u32, vec2f, vec3f
from ..gpu.memory import Texture
from ..gpu.raster import color_attachments, depth_attachment
from ..gpu.rows import Table
from ..gpu.slots import uniform
from ..scene.lights import Light
from .draw_parts import DrawParts, in_draw_order
from .draws import Draw
from .geometry import GpuScene
from .light_table import shared_fields
from .light_views import LightView, LightViewData
from .mesh_pass import MESH_SLOTS, MeshPass, MeshPipeline
from .packed_maps import uses_visibility_buffer
from .visibility_buffer import VISIBILITY_SLOTS, VisibilityBuffer

_STRONGEST = 1024.0  # of what is stored: sixty times below the largest half float


class ReflectiveParams(Struct):
    """The light and the view that is drawn."""

    clip_from_world = mat4x4f()
    color = vec3f("W m^-2 (directional) or W sr^-1")
    kind = u32()
    position = vec3f("m")
    shape_x = f32("of what the light sends by direction: `LightRow.shape`")
    direction = vec3f()
    shape_y = f32()
    inv_size = vec2f("of the map, px^-1")
    body = f32("m^2, square of the radius of the surface that gives the light; 0 without one")
    gap = f32("m, up to which what is close to it sends light back there")


class _ReflectivePipeline(MeshPipeline):
    slots = (uniform("params", ReflectiveParams), *MESH_SLOTS)
    targets: tuple[str, ...] = ("rgba16float", "rgba16float")
    depth_compare = "less-equal"  # as for cameras: of coincident surfaces the last drawn one
    maps = ("base_color", "metallic_roughness")
    file = "reflective.wgsl"


class _FluxFromIds(FullscreenPass):
    slots = (uniform("params", ReflectiveParams), *VISIBILITY_SLOTS)
    targets = _ReflectivePipeline.targets
    # Where a triangle is nearer than the clear value.
    depth, depth_compare = "depth32float", "greater"
    file = "visibility_flux.wgsl"


class _PassedPipeline(_ReflectivePipeline):
    """Translucent surfaces tint the flux of what lies behind them."""

    depth_compare, depth_writes = "less", False
    targets = ("rgba16float",)
    file = "passed_flux.wgsl"
    blend: ClassVar[dict[str, Any]] = {
        "color": {"operation": "add", "src_factor": "zero", "dst_factor": "src"},
        "alpha": {"operation": "add", "src_factor": "zero", "dst_factor": "one"},
    }


def flux_unit(light: Light) -> float:
    """What 1 stands for in a light's map, W m^-2 or W sr^-1: half floats end at 65504 and 6e-8.

    Scenes in centimetres have lights ten thousand times as strong as those in metres, scenes in
    kilometres lights a millionth as strong.
    """
    # A power of two, so that dividing by it rounds nothing.
    strongest = max(light.row().color)
    return float(2.0 ** np.ceil(np.log2(max(strongest, 1e-30) / _STRONGEST)))


class ReflectiveShadowMaps:
    """Arrays of square maps, redrawn where a light, its view or the geometry changed.

    normal  xyz world, facing the light; w as `InstanceData.size`
    flux    rgb reflected W per m^2 (parallel) or per sr (perspective) of texel, over `flux_unit`
    """

    def __init__(
        self, gpu: Gpu, label: str, resolution: int, layers: int, *, block: int = 1
    ) -> None:
        """`block`: texels along each side of a block that counts as one virtual point light."""
        # A layer for each view: depth, normal, and the flux that it reflects.
        self.resolution, self.layers, self.block = resolution, layers, block
        size = (resolution, resolution, layers) if layers else (1, 1, 1)

        def map_of(name: str, format: str) -> Texture:
            return Texture(gpu, f"{label} {name}", size, format, dimension="2d-array", target=True)

        self.depth = map_of("depth", "depth32float")
        self.normal = map_of("normal", "rgba16float")
        self.flux = map_of("flux", "rgba16float")
        self.views = Table(gpu, f"{label} views", LightViewData, max(1, layers))
        # How it is drawn, and what lies in it.
        self._pass, self._tint = MeshPass(gpu, _ReflectivePipeline), MeshPass(gpu, _PassedPipeline)
        self._visibility = (
            VisibilityBuffer(gpu, (resolution, resolution), _FluxFromIds, of_lights=True)
            if layers and uses_visibility_buffer(gpu)
            else None
        )
        self._parts = DrawParts(self._split)
        self._drawn: dict[int, tuple[int, bytes, Light] | None] = {}
        self.version = 0
        """Raised whenever a map is redrawn."""

    def encode(
        self,
        commands: Commands,
        scene: GpuScene,
        lights: Sequence[Light],
        views: list[LightView],
    ) -> bool:
        """Draw those `views` that changed; returns whether any did."""
        # Views whose light, camera or geometry changed.
        stale = []
        for layer, view in enumerate(views):
            key = (scene.version, view.clip_from_world.tobytes(), lights[view.light])
            if self._drawn.get(layer) != key:
                stale.append((layer, key))
        if stale:
            rows = [{**v.fields, "flux_unit": flux_unit(lights[v.light])} for v in views]
            self.views.write(pack_array(LightViewData, rows))
        for layer, key in stale:
            self._drawn[layer] = None  # until it is drawn: after an error nothing counts as drawn
            self._draw(commands, scene, layer, views[layer], lights[views[layer].light])
            self._drawn[layer] = key
        # Layers of lights that are no more hold no light.
        gone = [layer for layer in self._drawn if layer >= len(views)]
        for layer in gone:
            del self._drawn[layer]
            self._clear(commands, layer)
        self.version += bool(stale or gone)
        return bool(stale or gone)

    def _clear(self, commands: Commands, layer: int) -> None:
        """Clear the map of a light that no longer exists."""
        colors, depth = self._attachments(layer)
        with commands.render(
            "no reflective shadow map", color_attachments=colors, depth_stencil_attachment=depth
        ):
            pass

    def _attachments(
        self, layer: int, *, keep: bool = False
    ) -> tuple[list[dict[str, Any]], dict[str, Any]]:
        views = (self.normal.layer(layer), self.flux.layer(layer))
        depth = depth_attachment(self.depth.layer(layer), 1.0, keep=keep)
        return color_attachments(views, keep=keep), depth

    def _draw(
        self, commands: Commands, scene: GpuScene, layer: int, view: LightView, light: Light
    ) -> None:
        # Flux in a unit of its own, so that half floats hold that of any light.
        row, unit = light.row(), flux_unit(light)
        r, g, b = row.color
        params = ReflectiveParams(
            clip_from_world=view.clip_from_world,
            inv_size=2 * (1.0 / self.resolution,),
            **shared_fields(replace(row, color=(r / unit, g / unit, b / unit))),
            body=row.body,
            gap=row.gap,
        )
        # By triangle ids where the adapter is quicker so, and the rest as it comes.
        draws, keep = scene.visible(view.clip_from_world), False
        first, draws = self._parts.of(scene, draws)
        if self._visibility and (first or not draws):
            self._draw_triangle_ids(commands, scene, layer, view, params, first)
            keep = bool(first)
        if draws or not self._visibility:
            colors, depth = self._attachments(layer, keep=keep)
            with commands.render(
                "reflective shadow map", color_attachments=colors, depth_stencil_attachment=depth
            ) as encoder:
                self._pass.draw(commands, encoder, scene, draws, params)
        # Light that comes through translucent surfaces has their colour.
        translucent = scene.translucent(view.clip_from_world)
        if translucent:
            colors, depth = self._attachments(layer, keep=True)
            with commands.render(
                "passed flux", color_attachments=colors[1:], depth_stencil_attachment=depth
            ) as encoder:
                self._tint.draw(commands, encoder, scene, translucent, params)

    def _split(self, scene: GpuScene, draws: list[Draw]) -> tuple[list[Draw], list[Draw]]:
        """The draws for the visibility buffer, then the rest."""
        if self._visibility:
            return self._visibility.split(scene, draws)
        return [], in_draw_order(scene, draws)

    def _draw_triangle_ids(
        self,
        commands: Commands,
        scene: GpuScene,
        layer: int,
        view: LightView,
        params: ReflectiveParams,
        draws: list[Draw],
    ) -> None:
        """Draw `draws` by way of the visibility buffer."""
        assert self._visibility
        _, depth = self._attachments(layer)
        targets = (self.normal.layer(layer), self.flux.layer(layer))
        self._visibility.encode(
            commands, scene, draws, view.clip_from_world, depth, targets, params
        )
