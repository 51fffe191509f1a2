"""The transmittance of translucent surfaces towards a light, beside its shadow map.

rgb  the product of the shares that pass the translucent surfaces before the first solid one
a    where the first of them lies: depth of parallel light, metres along the axis in perspective

Points before the first surface get all light, points behind it as much as passes all of them:
between two panes light is as dark as behind both.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, mat4x4f, u32, vec3f
from ..gpu.memory import Texture
from ..gpu.raster import depth_attachment
from ..gpu.slots import uniform
from ..maths.half import HALF_MAX
from .geometry import GpuScene
from .light_views import LightView
from .mesh_pass import MESH_SLOTS, MeshPass, MeshPipeline


class PaneParams(Struct):
    """The light's view; `origin`: its position, or its direction where it is parallel."""

    clip_from_world = mat4x4f()
    origin = vec3f("m, or none")
    is_perspective = u32()


class _Panes(MeshPipeline):
    slots = (uniform("params", PaneParams), *MESH_SLOTS)
    targets = ("rgba16float",)
    depth_compare, depth_writes = "less", False
    maps = ("base_color", "metallic_roughness")
    file = "panes.wgsl"
    blend: ClassVar[dict[str, Any]] = {
        "color": {"operation": "add", "src_factor": "zero", "dst_factor": "src"},
        "alpha": {"operation": "min", "src_factor": "one", "dst_factor": "one"},
    }


class Panes:
    """The maps that belong to those of `depth`; without, a single texel that nobody reads."""

    def __init__(self, gpu: Gpu, label: str, depth: Texture | None) -> None:
        self._depth = depth
        size = depth.size if depth else (1, 1, 1)
        self.light = Texture(
            gpu, f"{label} panes", size, "rgba16float", dimension="2d-array", target=True
        )
        self._pass = MeshPass(gpu, _Panes)

    def draw(self, commands: Commands, scene: GpuScene, layer: int, view: LightView) -> None:
        """Draw one map, after its depth."""
        if self._depth is None:
            return
        # White where nothing is in the way; depth is that of opaque surfaces, which hide what is
        # behind.
        color = {
            "view": self.light.layer(layer),
            "load_op": "clear",
            "store_op": "store",
            "clear_value": (1.0, 1.0, 1.0, HALF_MAX),
        }
        with commands.render(
            self.light.label,
            color_attachments=[color],
            depth_stencil_attachment=depth_attachment(self._depth.layer(layer), 1.0, keep=True),
        ) as encoder:
            draws = scene.translucent(view.clip_from_world)
            self._pass.draw(commands, encoder, scene, draws, _params(view))


def _params(view: LightView) -> PaneParams:
    # All rays of a view meet in the light; parallel ones nowhere, and have a direction.
    meeting = np.linalg.inv(view.clip_from_world)[:, 2]
    origin = meeting[:3] / meeting[3] if view.is_perspective else meeting[:3]
    return PaneParams(
        clip_from_world=view.clip_from_world,
        origin=tuple(origin),
        is_perspective=int(view.is_perspective),
    )
