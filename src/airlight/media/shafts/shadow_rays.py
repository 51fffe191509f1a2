"""What passes bind to walk eye rays over shadow maps: hierarchies of depth, lights and media."""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32
from ...gpu.slots import Slot, image, storage, uniform
from ...lighting.lights import Lights
from ...surface.light_table import LIGHT_VIEW_SLOTS
from ..gpu_media import GpuMedia
from ..rays import RayParams, Rays
from .bounds import DepthBounds


class ShaftParams(Struct):
    """The sizes of the lights' maps, and how long a ray may take."""

    max_nodes = u32("squares opened or crossed before coarse ones are taken as they are")
    parallel_resolution = u32("texels")
    parallel_side = u32("texels, a power of two")
    parallel_top = u32("level a ray starts at")
    local_resolution = u32("texels")
    local_side = u32("texels, a power of two")
    local_top = u32("level a ray starts at")


class ShadowRays:
    """The lights, their shadow maps as hierarchies, and the media of one scene."""

    def __init__(
        self, gpu: Gpu, media: GpuMedia, lights: Lights, *, max_nodes: int, steps: int
    ) -> None:
        """`max_nodes` squares at most for a ray; `steps` of it where there are density grids."""
        self.gpu, self._media, self._max_nodes = gpu, media, max_nodes
        # Hierarchies for the maps of directional and of local lights.
        self._parallel = DepthBounds(gpu, lights.parallel)
        self._local = DepthBounds(gpu, lights.local)
        self.wgsl = lit_interval_wgsl(media, lights, steps)

    def slots(self, *more: Slot) -> tuple[Slot, ...]:
        """The slots of a pass that uses wgsl/shaft_rays.wgsl, with `more` of its own."""
        return (
            uniform("rays", RayParams),
            uniform("shafts", ShaftParams),
            *self._media.slots,
            *LIGHT_VIEW_SLOTS,
            storage("parallel_bounds", "u32"),
            storage("local_bounds", "u32"),
            *more,
            image("scattered", "rgba32float"),
        )

    def encode(self, commands: Commands) -> None:
        """Compute the hierarchies, after shadow maps changed."""
        self._parallel.encode(commands)
        self._local.encode(commands)

    def bound(self, rays: Rays, lights: Lights) -> dict[str, Any]:
        """The resources of such a pass, by slot name."""
        parallel, local = self._parallel, self._local
        # Maps of both kinds of lights have sizes of their own, and levels over them (Chen2011).
        shafts = ShaftParams(
            max_nodes=self._max_nodes,
            parallel_resolution=parallel.maps.depth.size[0],
            parallel_side=parallel.side,
            parallel_top=parallel.top,
            local_resolution=local.maps.depth.size[0],
            local_side=local.side,
            local_top=local.top,
        )
        return {
            "rays": rays.params,
            "shafts": shafts,
            **self._media.bound,
            "lights": lights.table,
            "parallel_views": lights.parallel.views,
            "local_views": lights.local.views,
            "parallel_bounds": parallel.buffer,
            "local_bounds": local.buffer,
        }


def lit_interval_wgsl(media: GpuMedia, lights: Lights, steps: int = 32) -> str:
    """How lit intervals are integrated, and what is known beforehand: which media and lights."""
    use = "//! use lit_interval\n"
    if media.has_grids:
        use = f"const GRID_STEPS = {steps}.0;\n//! use lit_interval_grids\n"
    # Constants, by which the compiler leaves out what this scene does not need.
    known = {
        "IS_ONE_BOX": media.is_one_box,
        "HAS_DIRECTIONAL": lights.parallel.layers > 0,
        "HAS_LOCAL": lights.local.layers > 0,
    }
    wgsl = media.wgsl + f"const LIGHT_COUNT = {lights.count}u;\n"
    return wgsl + "".join(f"const {k} = {str(v).lower()};\n" for k, v in known.items()) + use
