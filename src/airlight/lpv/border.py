"""Light that enters a finer lattice from the larger one around it.

differs: Kaplanyan2010 section 4.1 propagates every lattice alone, so a finer one lacks the light of
all surfaces beyond its border. Here the larger lattice is solved first; what its light, in the
layer of cells just outside, would hand on in one hop is put into the finer lattice's outermost
cells. The converged state of a lattice cut out of another is then the other's.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32
from ..gpu.memory import Buffer
from ..gpu.slots import Slot, sampler, storage, uniform
from ..lattice.blockers import BLOCKER_SLOTS
from ..lattice.lobes import InjectionTarget
from ..lattice.lookup import CHANNEL_SLOTS
from ..lattice.placement import LatticeParams, Placement
from .step import hop_constants


class BorderParams(Struct):
    """How the textures' values become fixed-point units of the finer lattice."""

    units = f32("fixed-point units per stored unit, in a cell as small as the finer lattice's")


class Border(ComputePass):
    """Adds the light that enters through the six sides to a lattice's fixed-point sums."""

    slots: tuple[Slot, ...] = (
        uniform("params", BorderParams),
        uniform("lattice", LatticeParams),
        uniform("outer", LatticeParams),
        *CHANNEL_SLOTS,
        *BLOCKER_SLOTS,
        sampler("linear_clamp"),
        storage("faces", "vec4u"),
        storage("sums", "atomic<i32>", "read_write"),
    )
    workgroup = (8, 8, 1)

    def __init__(self, gpu: Gpu) -> None:
        super().__init__(gpu, constants=hop_constants())

    def encode(
        self,
        commands: Commands,
        target: InjectionTarget,
        outer: Placement,
        solved: dict[str, Any],
        faces: Buffer,
        *,
        power_scale: float,
    ) -> None:
        """Add to the lattice of `target` what enters it from the solved `outer`.

        `faces`: the finer lattice's, as lattice.blockers.Blockers. `solved`: the textures that both
        share, of `power_scale` stored units per W sr^-1, and their sampler.
        """
        # Power through a face goes with its area; both lattices count it in units of their own.
        inner = target.placement
        # A face of a finer cell takes its share of the larger face that it lies in.
        area = (inner.cell / outer.cell) ** 2
        side = max(inner.count)
        self.dispatch(
            commands,
            (side, side, 6),
            params=BorderParams(units=area * target.scale / power_scale),
            lattice=inner.params(power_scale),
            outer=outer.params(power_scale),
            **solved,
            faces=faces,
            sums=target.sums,
        )
