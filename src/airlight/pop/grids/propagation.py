"""Hops through all grids of a medium's lights, and what they leave in the medium's own cells."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import DeviceError
from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...maths.ordinates import Ordinates
from ...maths.transforms import F64
from ..light.ordinates import Lamp, OrdinateTable
from ..medium.density import Density
from ..medium.placement import MediumParams, MediumPlacement
from ..virtual.grids import VirtualGrids
from .grids import HopGrids
from .merge import Merge
from .propagate import Propagate, chain_bytes


class Hopping:
    """Grids of lights that are rows of an `OrdinateTable`; of virtual lights, too."""

    def __init__(
        self,
        gpu: Gpu,
        placement: MediumPlacement,
        side: int,
        most: int,
        *,
        is_paper: bool = False,
        merged: Buffer | None = None,
    ) -> None:
        """At most `most` grids of about `side`^3 cells. `merged`: where it goes, if not its own."""
        self.is_paper = is_paper
        _require_room(gpu, side, most)
        self.grids = HopGrids(gpu, placement, side, most)
        self.chain = Propagate(gpu, self.grids.capacity, most)
        self.merge = Merge(gpu, placement, merged)
        self._virtual = VirtualGrids(gpu)
        self._prefilter = True

    def write(
        self,
        ordinates: Ordinates,
        lamps: Sequence[Lamp],
        placement: MediumPlacement,
        *,
        prefilter: bool,
        scale: float,
        virtual: int = 0,
        first_row: int = 0,
    ) -> None:
        """Place the grids; see `HopGrids.write`."""
        self._prefilter = prefilter
        self.grids.write(
            ordinates,
            lamps,
            placement,
            prefilter=prefilter,
            scale=scale,
            virtual=virtual,
            first_row=first_row,
        )

    def encode_grids(
        self, commands: Commands, params: MediumParams, ordinates: Buffer, density: Density
    ) -> None:
        """Place those of virtual lights, and fill all with air."""
        hops = self.grids.params((0.0, 0.0, 0.0), is_paper=self.is_paper)
        if self.grids.virtual:
            self._virtual.encode(
                commands, params, hops, self.grids, ordinates, prefilter=self._prefilter
            )
        self.grids.encode(commands, params, hops, density)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        table: OrdinateTable,
        passed: Buffer,
        density: Density,
        deposits: Buffer,
        eye: F64,
        iterations: int,
        *,
        is_added: bool = False,
    ) -> None:
        """Hop; fill `merge.merged` for an eye (3,), m in the medium's frame, and `deposits`."""
        hops = self.grids.params(eye, is_paper=self.is_paper, is_added=is_added)
        with commands.stage("pop initialisation"):
            self.chain.encode_begin(
                commands, params, self.grids, table.rows, passed, eye, is_paper=self.is_paper
            )
        with commands.stage("pop propagation"):
            self.chain.encode(commands, params, self.grids, eye, iterations, is_paper=self.is_paper)
        with commands.stage("pop merge"):
            self.merge.encode(
                commands, params, hops, self.grids, self.chain.gathered, density.cells, deposits
            )


def _require_room(gpu: Gpu, side: int, most: int) -> None:
    needed, limit = chain_bytes(side, most), gpu.limits["max-storage-buffer-binding-size"]
    if needed > limit:
        raise DeviceError(
            f"hops in {most} grids of {side}^3 cells need {needed >> 20} MB in one piece, "
            f"{gpu.info.name} has {limit >> 20}",
            remedy="Take fewer ordinates or virtual_lights, or a smaller grid",
        )
