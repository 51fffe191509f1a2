"""Light that media only scatter forwards, as surfaces read it: in textures of nested lattices."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.irradiance import Irradiance
from ..lattice.placement import Placement
from ..lattice.table import LatticeTable
from ..lighting.kit import Kit
from .surface_light import NO_MEDIUM, SurfaceLight


class SurfaceBeams:
    """The irradiance of beams, which `scatter.forward` finds in cells."""

    def __init__(self, gpu: Gpu, kit: Kit) -> None:
        self._kit = kit
        # Textures of their own, with a table by whose scale they are read.
        self._textures = SurfaceLight(gpu, kit.placement, kit.lattices.texture_size)
        self._table = LatticeTable(gpu, kit.lattices.table.count)

    def encode(
        self, commands: Commands, beams: Buffer, black: Buffer, flux: float, placement: Placement
    ) -> None:
        """Fill the part of a lattice from `beams`, W m; `black`: no light, as many cells.

        `flux`, W, bounds what comes into all lattices.
        """
        self._textures.encode(commands, black, flux, NO_MEDIUM, forward=beams, placement=placement)

    @property
    def field(self) -> Irradiance:
        """As lighting and the gather read it."""
        rows = [self._textures.params(place) for place in self._kit.lattices.placements]
        return Irradiance({"lattices": self._table.filled(rows), **self._textures.bound})
