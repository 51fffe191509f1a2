"""First-scattered light into cells (Billeter2012 sections 3.1 and 4.1).

Each cell gathers: an eighth of it at a time, how much light arrives (shadow map, attenuation) and
scatters there, sigma_s E s^3, as isotropic power. Its own track starts with the second scattering:
the first is drawn by itself, sharply.
differs: Billeter2012 section 4.1 scatters up to eight random points of every shadow-map texel's
ray into cells; see inject_rays, which does, for light through gaps smaller than a cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeParams, Placement
from ..media.gpu_media import GpuMedia
from ..media.stale_cells import ALL_CELLS, LISTED_CELLS, STALE_CELL_SLOTS, StaleCells
from .cell_lights import ALL_LIGHTS, CELL_LIGHT_SLOTS, SKY_LIGHTS, CellLights
from .reduced_media import SLANT_MEDIA


class SingleParams(Struct):
    """How many lights there are, and where they shine."""

    light_count = u32()
    is_listed = u32("1: into cells of the list alone")


ROW_BYTES = 48
"""Of a cell's unscattered light, as `CellFluence` has it."""

# Light is kept where rays meet it in the air, added to other light's or alone.
_DROP = """const KEEPS_LIGHT = false;
fn keep_light(cell: u32, light: Arriving) {}
"""
_KEEP = """const KEEPS_LIGHT = true;
fn keep_light(cell: u32, light: Arriving) {
    let row = 3u * cell;
    unscattered[row] = vec4f(unscattered_base[row].rgb + light.reduced, 0.0);
    unscattered[row + 1u] = vec4f(unscattered_base[row + 1u].rgb + light.straight, 0.0);
    unscattered[row + 2u] = vec4f(unscattered_base[row + 2u].rgb + light.along, 0.0);
}
"""
_KEEP_ALONE = """const KEEPS_LIGHT = true;
fn keep_light(cell: u32, light: Arriving) {
    let row = 3u * cell;
    unscattered[row] = vec4f(light.reduced, 0.0);
    unscattered[row + 1u] = vec4f(light.straight, 0.0);
    unscattered[row + 2u] = vec4f(light.along, 0.0);
}
"""


@dataclass(frozen=True, eq=False)
class CellFluence:
    """Unscattered light in each cell, three rows of rgb W m^-2: `after` = `base` + the lights'.

    Its fluence as reduced media attenuate it, and as the media themselves do; of that the flux of
    its luminance, x y z of the world. Means over what scatters in the cell. `base`: None where
    there is no other light.
    """

    base: Buffer | None
    after: Buffer


class InjectSingle(ComputePass):
    """cells = base + light scattered once, W; the lights' shadow maps are drawn."""

    workgroup = (32, 4, 2)

    def __init__(
        self,
        gpu: Gpu,
        media: GpuMedia,
        *,
        keeps_light: bool = False,
        is_first: bool = False,
    ) -> None:
        """`keeps_light`: `encode` is given a CellFluence to fill.

        `is_first`: there is no light before that of these lights, and only stale cells are computed
        where `encode` is given a list of them.
        """
        self._media, self._is_first = media, is_first
        # Fluence is added to that of other light, or is the first.
        kept = (
            storage("unscattered_base", "vec4f"),
            storage("unscattered", "vec4f", "read_write"),
        )
        keep = _KEEP_ALONE if is_first else _KEEP
        self.slots = (
            uniform("params", SingleParams),
            uniform("lattice", LatticeParams),
            *CELL_LIGHT_SLOTS,
            *media.slots,
            storage("base", "vec4f"),
            storage("cells", "vec4f", "read_write"),
            *(kept[is_first:] if keeps_light else ()),
            *(STALE_CELL_SLOTS if is_first else ()),
        )
        cells, lights = (LISTED_CELLS, SKY_LIGHTS) if is_first else (ALL_CELLS, ALL_LIGHTS)
        slants = f"const SLANT_MEDIA = {SLANT_MEDIA}u;\n"
        kept_wgsl = keep if keeps_light else _DROP
        super().__init__(gpu, generated=media.wgsl + cells + slants + kept_wgsl + lights)

    def encode(
        self,
        commands: Commands,
        placement: Placement,
        lights: CellLights,
        *,
        base: Buffer,
        cells: Buffer,
        fluence: CellFluence | None = None,
        stale: StaleCells | None = None,
    ) -> None:
        """Gather of `lights`; `cells` must not be `base`. `fluence`: of the light that arrives.

        The media's coefficients count as isotropic. `stale`, where it `is_first`: the cells that
        are computed; the others' light stays as it was.
        """
        # The light that is there already, and which cells are computed.
        kept: dict[str, Any] = {"unscattered": fluence.after} if fluence else {}
        if fluence and fluence.base:
            kept["unscattered_base"] = fluence.base
        if stale:
            kept |= stale.bound
        self.dispatch(
            commands,
            placement.count,
            params=SingleParams(
                light_count=lights.count, is_listed=bool(stale and stale.is_listed)
            ),
            lattice=placement.params(),
            base=base,
            cells=cells,
            **lights.bound,
            **self._media.bound,
            **kept,
        )
