"""First-scattered light into cells (Billeter2012 sections 3.1 and 4.1).

Each cell gathers: an eighth of it at a time, how much light arrives (shadow map, attenuation) and
scatters there, sigma_s E s^3, as isotropic power. Its own track starts with the second scattering:
the first is drawn by itself, sharply.
differs: Billeter2012 section 4.1 scatters up to eight random points of every shadow-map texel's
ray into cells; see inject_rays, which does, for light through gaps smaller than a cell.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import sampler, storage, texture, uniform
from ..lattice.placement import LatticeParams, Placement
from ..media.gpu_media import GpuMedia
from ..surface.light_table import LightData
from ..surface.light_views import LightViewData


class SingleParams(Struct):
    """How many lights there are."""

    light_count = u32()


class InjectSingle(ComputePass):
    """cells = base + light scattered once, W; the lights' shadow maps are drawn."""

    workgroup = (32, 4, 2)

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self._media = media
        self.slots = (  # type: ignore[misc]
            uniform("params", SingleParams),
            uniform("lattice", LatticeParams),
            storage("lights", LightData),
            storage("parallel_views", LightViewData),
            storage("local_views", LightViewData),
            texture("parallel_shadows", "2d-array", "depth"),
            texture("local_shadows", "2d-array", "depth"),
            sampler("shadow_compare", "comparison"),
            texture("lattice_walls", "3d"),
            *media.slots,
            storage("base", "vec4f"),
            storage("cells", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=media.wgsl)

    def encode(
        self,
        commands: Commands,
        placement: Placement,
        lights: dict[str, Any],
        count: int,
        *,
        walls: Texture,
        base: Buffer,
        cells: Buffer,
    ) -> None:
        """`lights`: `lights`, views, shadows and `shadow_compare` as in Lights.bound.

        `count` of them shine; `cells` must not be `base`. The media's coefficients count as
        isotropic.
        """
        names = (
            "lights",
            "parallel_views",
            "local_views",
            "parallel_shadows",
            "local_shadows",
            "shadow_compare",
        )
        self.dispatch(
            commands,
            placement.count,
            params=SingleParams(light_count=count),
            lattice=placement.params(),
            lattice_walls=walls,
            base=base,
            cells=cells,
            **{name: lights[name] for name in names},
            **self._media.bound,
        )
