"""Shadow maps: depth as lights see it, filtered by percentage-closer comparison.

A translucent surface stands in one map by the chance that light meets it there (`is_thinned`: where
many maps are averaged, the shadow is as grey as it should be), or not at all, and `panes` tints the
light that passes.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import pack_array
from ..gpu.memory import Sampler, Texture
from ..gpu.raster import depth_attachment
from ..gpu.rows import Table
from ..gpu.slots import uniform
from .geometry import GpuScene
from .light_views import LightView, LightViewData, stale_layers
from .mesh_pass import MESH_SLOTS, DepthPipeline, MeshPass, MeshPipeline, ViewParams
from .panes import Panes

_LEAST_SIDE = 16


class _CutoutPipeline(MeshPipeline):
    slots = (uniform("params", ViewParams), *MESH_SLOTS)
    depth_compare = "less"
    maps = ("base_color",)
    file = "shadow.wgsl"


class _OpaquePipeline(DepthPipeline):
    slots = _CutoutPipeline.slots
    depth_compare = "less"


class ShadowMaps:
    """An array of square depth maps, redrawn where a view or the geometry changed."""

    def __init__(
        self,
        gpu: Gpu,
        label: str,
        resolution: int,
        layers: int,
        *,
        is_thinned: bool = False,
        has_panes: bool = False,
    ) -> None:
        """`has_panes`: whether the light that passes translucent surfaces is drawn, too."""
        self.resolution, self.layers, self._is_thinned = resolution, layers, is_thinned
        count = max(1, layers)
        side = resolution if layers else 1
        # A scene without such lights still binds a map, of one texel.
        self.depth = Texture(
            gpu, label, (side, side, count), "depth32float", dimension="2d-array", target=True
        )
        self.views = Table(gpu, f"{label} views", LightViewData, count)
        self.sampler = comparison_sampler(gpu)
        self.panes = Panes(gpu, label, self.depth if has_panes and layers else None)
        self._pass = MeshPass(gpu, _CutoutPipeline, opaque=_OpaquePipeline)
        self._drawn: dict[int, tuple[int, bytes]] = {}
        self.version = 0  # raised whenever a map is redrawn

    def encode(self, commands: Commands, scene: GpuScene, views: list[LightView]) -> None:
        """Draw those `views` that changed."""
        # A map holds as long as its view and the geometry do.
        stale = stale_layers(self._drawn, scene.version, views)
        if not stale:
            return
        # Views are uploaded together, maps drawn one by one.
        self.version += 1
        self.views.write(pack_array(LightViewData, [view.fields for view in views]))
        for layer in stale:
            self._draw(commands, scene, layer, views[layer])
            self.panes.draw(commands, scene, layer, views[layer])

    def _draw(self, commands: Commands, scene: GpuScene, layer: int, view: LightView) -> None:
        depth = depth_attachment(self.depth.layer(layer), 1.0)
        # Depth alone: the nearest surface to the light at each texel.
        with commands.render(
            self.depth.label, color_attachments=[], depth_stencil_attachment=depth
        ) as encoder:
            clip = view.clip_from_world
            draws = scene.visible(clip) if self._is_thinned else scene.solid(clip)
            self._pass.draw(commands, encoder, scene, draws, ViewParams(clip_from_world=clip))


def affordable_side(asked: int, layers: int, most_texels: int) -> int:
    """The side of `layers` square maps: `asked`, halved until all have at most `most_texels`.

    They count as if a side were a power of two, as hierarchies over them have it.
    """
    side = asked
    while layers << (2 * (side - 1).bit_length()) > most_texels and side > _LEAST_SIDE:
        side //= 2
    return side


def comparison_sampler(gpu: Gpu) -> Sampler:
    """Compares depth: 1 where the reference is not beyond the stored depth; bilinear."""
    return Sampler(gpu, "shadow", compare="less-equal", mag_filter="linear", min_filter="linear")
