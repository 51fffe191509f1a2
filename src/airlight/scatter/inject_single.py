"""First-scattered light into cells (Billeter2012 sections 3.1 and 4.1).

Each cell gathers: an eighth of it at a time, how much light arrives (shadow map, attenuation) and
scatters there, sigma_s E s^3, as isotropic power. Its own track starts with the second scattering:
the first is drawn by itself, sharply.
differs: Billeter2012 section 4.1 scatters up to eight random points of every shadow-map texel's
ray into cells; see inject_rays, which does, for light through gaps smaller than a cell.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeParams, Placement
from ..media.gpu_media import GpuMedia
from .cell_lights import CELL_LIGHT_SLOTS, CellLights


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
            *CELL_LIGHT_SLOTS,
            *media.slots,
            storage("base", "vec4f"),
            storage("cells", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=media.wgsl)

    def encode(
        self,
        commands: Commands,
        placement: Placement,
        lights: CellLights,
        *,
        base: Buffer,
        cells: Buffer,
    ) -> None:
        """Gather of `lights`; `cells` must not be `base`.

        The media's coefficients count as isotropic.
        """
        self.dispatch(
            commands,
            placement.count,
            params=SingleParams(light_count=lights.count),
            lattice=placement.params(),
            base=base,
            cells=cells,
            **lights.bound,
            **self._media.bound,
        )
