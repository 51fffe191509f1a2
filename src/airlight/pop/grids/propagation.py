"""Propagation through all grids of a medium's lights, and its result on the medium's own cells."""

from __future__ import annotations

from ...errors import DeviceError
from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...maths.transforms import F64
from ..light.incident import IncidentLight
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams
from ..settings import PopSettings
from ..virtual.grids import VirtualGrids
from .grids import GridLights, Grids
from .merge import Merge
from .propagate import Propagate, chain_bytes


class GridPropagation:
    """Grids of lights that are rows of an `OrdinateTable`, virtual point lights among them."""

    def __init__(
        self,
        medium: GridMedium,
        settings: PopSettings,
        most: int,
        *,
        is_paper: bool = False,
        is_added: bool = False,
        merged: Buffer | None = None,
    ) -> None:
        """For at most `most` grids.

        `is_added`: the residuum is added to the deposits of beams. `merged`: the buffer of another
        pass for the merged light, if any. Raises DeviceError where the device has not enough room.
        """
        # The states of all grids lie in one buffer each, which a device may not have room for.
        _require_room(medium.gpu, settings.grid, most)
        self.iterations, self._is_added = settings.iterations, is_added
        self.grids = Grids(medium, settings, most, is_paper=is_paper)
        self.propagate = Propagate(medium.gpu, self.grids, most)
        self.merge = Merge(medium, self.grids, merged)
        self._virtual = VirtualGrids(medium.gpu)

    def write(self, lights: GridLights) -> None:
        """Place the grids; see `Grids.write`."""
        self.grids.write(lights)

    def encode_grids(self, commands: Commands, params: MediumParams, ordinates: Buffer) -> None:
        """Place the grids of virtual point lights, and fill all with the medium."""
        # The device alone knows where virtual point lights are, so it places their grids.
        if self.grids.virtual:
            self._virtual.encode(commands, params, self.grids, ordinates)
        self.grids.encode(commands, params)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        light: IncidentLight,
        eye: F64,
        deposits: Buffer,
    ) -> None:
        """Fill `merge.merged` for an eye (3,), m in the frame of the medium, and `deposits`."""
        # Light that scatters once in every cell of every grid.
        with commands.stage("pop initialisation"):
            self.propagate.encode_begin(commands, params, light, eye)
        # From cell to cell; what the eye sees of it is gathered as it goes.
        with commands.stage("pop propagation"):
            self.propagate.encode(commands, params, eye, self.iterations)
        # All grids on the cells of the medium.
        with commands.stage("pop merge"):
            hops = self.grids.params(eye, is_added=self._is_added)
            self.merge.encode(commands, params, hops, self.propagate.gathered, deposits)


def _require_room(gpu: Gpu, side: int, most: int) -> None:
    # The states of all grids lie in one buffer, whose size devices limit.
    needed, limit = chain_bytes(side, most), gpu.limits["max-storage-buffer-binding-size"]
    if needed > limit:
        raise DeviceError(
            f"{most} grids of {side}^3 cells need {needed >> 20} MB in one piece, "
            f"{gpu.info.name} has {limit >> 20}",
            remedy="Take fewer ordinates or virtual_lights, or a smaller grid",
        )
