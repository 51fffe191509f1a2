"""Surfaces as views see them, depth-peeled (Everitt2001): samples for volumes of blockers.

Kaplanyan2010 section 3.2 re-uses the camera's and the lights' buffers, down-sampled, and mentions
depth peeling for more. These views are drawn for the purpose, since reflectance is needed too; a
view is redrawn only where it or the geometry changed.
"""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, mat4x4f, pack_array, u32
from ..gpu.memory import Texture
from ..gpu.raster import color_attachments, depth_attachment
from ..gpu.rows import Table
from ..gpu.slots import texture, uniform
from ..maths.transforms import F64, triple
from ..scene.camera import Camera
from .geometry import GpuScene
from .light_views import LightView, LightViewData, perspective, stale_layers
from .mesh_pass import MESH_SLOTS, MeshPass, MeshPipeline

_WIDEST_DEG = 140.0


class SurfelViewParams(Struct):
    """The view that is drawn."""

    clip_from_world = mat4x4f()
    is_peeled = u32("1: only what lies behind the layer before")


class _SurfelPipeline(MeshPipeline):
    slots = (uniform("params", SurfelViewParams), texture("previous", "2d", "depth"), *MESH_SLOTS)
    targets = ("rgba16float", "rgba8unorm")
    depth_compare = "less"
    maps = ("base_color", "metallic_roughness")
    file = "surfel_views.wgsl"


class SurfelViews:
    """Arrays of square maps, `peels` layers in a row for each of `count` views.

    depth        conventional, 1 where nothing is
    normal       xyz world, facing the viewer
    reflectance  rgb bihemispherical albedo, linear
    """

    def __init__(self, gpu: Gpu, resolution: int, count: int, peels: int) -> None:
        self.resolution, self.count, self.peels = resolution, count, peels
        size = (resolution, resolution, max(1, count * peels))

        def map_of(name: str, format: str) -> Texture:
            label = f"surfel {name}"
            return Texture(gpu, label, size, format, dimension="2d-array", target=True)

        self.depth = map_of("depth", "depth32float")
        self.normal = map_of("normal", "rgba16float")
        self.reflectance = map_of("reflectance", "rgba8unorm")
        self._nothing = Texture(gpu, "no depth", (1, 1), "depth32float", target=True)
        self.views = Table(gpu, "surfel views", LightViewData, max(1, count))
        self._pass = MeshPass(gpu, _SurfelPipeline)
        self._drawn: dict[int, tuple[int, bytes]] = {}

    def encode(self, commands: Commands, scene: GpuScene, views: list[LightView]) -> bool:
        """Draw those of `views` that changed; returns whether any did."""
        # Views whose camera or geometry changed since their layers were drawn.
        stale = stale_layers(self._drawn, scene.version, views)
        if stale:
            self.views.write(pack_array(LightViewData, [view.fields for view in views]))
        # Peel by peel, each behind the one before.
        for index in stale:
            for peel in range(self.peels):
                self._draw(commands, scene, index, peel, views[index])
        return bool(stale)

    def _draw(
        self, commands: Commands, scene: GpuScene, index: int, peel: int, view: LightView
    ) -> None:
        # A view's layers lie in a row.
        layer = index * self.peels + peel
        targets = (self.normal.layer(layer), self.reflectance.layer(layer))
        # Behind the layer before, of which the first has none.
        params = SurfelViewParams(clip_from_world=view.clip_from_world, is_peeled=int(peel > 0))
        previous = self.depth.layer(layer - 1) if peel else self._nothing
        with commands.render(
            "surfel view",
            color_attachments=color_attachments(targets),
            depth_stencil_attachment=depth_attachment(self.depth.layer(layer), 1.0),
        ) as encoder:
            draws = scene.visible(view.clip_from_world)
            self._pass.draw(commands, encoder, scene, draws, params, previous=previous)


def camera_view(camera: Camera, aspect: float, low: F64, high: F64, resolution: int) -> LightView:
    """What the camera sees, in a square image; `aspect` is its width over its height."""
    # The wider side's angle, up to where a perspective would waste its texels on the rim.
    half = np.tan(np.radians(camera.fov_y_deg) / 2.0) * max(1.0, aspect)
    fov = float(min(2.0 * np.arctan(half), np.radians(_WIDEST_DEG)))
    axes = triple(np.subtract(camera.target, camera.position)), camera.up
    return perspective(camera.position, axes, fov, 0, (low, high), resolution)
