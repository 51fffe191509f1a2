"""The light that reaches the cells of one medium, ordinate by ordinate.

write    ordinates, local lights and surfaces of the frame
encode   virtual point lights -> column density of every path -> shadows of surfaces
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...gpu.commands import Commands
from ...gpu.memory import Buffer
from ...gpu.slots import Slot, storage
from ...maths.ordinates import Ordinates
from ...scene.lights import Light
from ..exchange.irradiance import InterMediumLight
from ..medium.grid_medium import GridMedium
from ..medium.mixture import Mixture
from ..medium.placement import MediumParams
from ..settings import PopSettings
from ..virtual.lights import VirtualLights
from .paths import Paths
from .sky_correction import SkyLight
from .table import LocalLight, OrdinateData, OrdinateTable
from .visibility import Surfaces, Visibility


class IncidentLight:
    """The ordinates of one medium, and how much of each reaches every cell.

    `table`: the ordinates: distant light, local lights, virtual point lights, blocks of other
    media. `passed`: column densities and visibility, see `Paths`.
    """

    def __init__(
        self,
        medium: GridMedium,
        mixture: Mixture,
        settings: PopSettings,
        capacity: int,
        *,
        takes_others: bool = False,
    ) -> None:
        """For at most `capacity` ordinates besides blocks.

        `takes_others`: whether light of the other media in `mixture` arrives, and those beyond the
        medium's box attenuate; else the world ends at the box.
        """
        self._medium, self.mixture, self._prefilter = medium, mixture, settings.prefilter
        # The light of other media comes as the last ordinates.
        self.blocks = mixture.blocks if takes_others else 0
        self.table = OrdinateTable(
            medium.gpu, capacity + self.blocks, blocks=self.blocks, prefilter=settings.prefilter
        )
        self._paths = Paths(medium, mixture, self.table.capacity)
        self._inter_medium = InterMediumLight(medium, mixture) if self.blocks else None
        # Surfaces, and what they reflect, come with the first frame that has any.
        self._visibility: Visibility | None = None
        self._virtual: VirtualLights | None = None
        self._surfaces: Surfaces | None = None

    @property
    def slots(self) -> tuple[Slot, ...]:
        """Of passes that sum over all ordinates in each cell; `bound` binds them."""
        return (
            storage("ordinates", OrdinateData),
            storage("passed", "f32"),
            *self.mixture.beam_slots,
        )

    @property
    def bound(self) -> dict[str, Any]:
        """By the names of `slots`."""
        return {
            "ordinates": self.table.rows,
            "passed": self.passed,
            **self.mixture.beam_bound,
        }

    @property
    def passed(self) -> Buffer:
        """f32 [2 * media][ordinate][cell], see `Paths`."""
        return self._paths.passed

    def write(self, ordinates: Ordinates, local: Sequence[LocalLight], scale: float = 0.0) -> None:
        """Upload the light of a frame; `scale` as in `OrdinateTable.write`."""
        medium = self._medium
        self.table.write(ordinates, local, medium.placement, medium.volume.g, scale)

    def write_correction(self, sky: SkyLight | None) -> None:
        """Make single scattering of a sky exact, after `write`; None leaves it as it is."""
        medium, table = self._medium, self.table
        table.correction.write(sky, medium.placement, medium.volume.g, prefilter=self._prefilter)

    def write_surfaces(
        self,
        ordinates: Ordinates,
        lights: tuple[Light, ...],
        surfaces: Surfaces,
        *,
        in_grids: bool,
    ) -> None:
        """Take the surfaces of a frame; virtual lights propagate `in_grids`, or are beams."""
        if self._visibility is None:
            self._visibility = Visibility(self._medium, self.table.capacity)
        # Shadow maps do not know virtual point lights, which the lattice shades, nor blocks.
        unshaded = surfaces.virtual_lights + self.blocks
        self._visibility.write(ordinates, lights, surfaces.sky, unshaded)
        self._surfaces = surfaces
        if self._virtual is None and surfaces.reflected is not None:
            self._virtual = VirtualLights(self._medium, surfaces.reflected, in_grids=in_grids)

    def forget(self) -> None:
        """The medium, or one that it meets, moved or changed."""
        if self._inter_medium is not None:
            self._inter_medium.forget()

    def encode_others(self, commands: Commands, *, is_lit: bool) -> None:
        """Receive light of the other media as they are solved; not `is_lit`: their blocks only."""
        if self._inter_medium is not None:
            with commands.stage("pop other media"):
                self._inter_medium.encode(commands, self.table, self._surfaces, is_lit=is_lit)

    def encode(self, commands: Commands, params: MediumParams) -> None:
        """Fill `passed`, and the rows of virtual point lights."""
        virtual, surfaces, table = self._virtual, self._surfaces, self.table
        # Virtual point lights are sampled before any path towards them can be marched.
        if virtual is not None and surfaces is not None:
            first = table.count - surfaces.virtual_lights - self.blocks
            with commands.stage("pop virtual lights"):
                virtual.encode(commands, table, first)
        # Media between each cell and each ordinate.
        with commands.stage("pop paths"):
            self._paths.encode(commands, params, table, is_closed=not self.blocks)
        # Surfaces between them: by shadow maps, and by the blockers of the lattice.
        if self._visibility is not None and surfaces is not None:
            with commands.stage("pop visibility"):
                self._visibility.encode(commands, params, table.count, surfaces, self.passed)
        if virtual is not None:
            with commands.stage("pop visibility"):
                virtual.encode_visibility(commands, params, self.passed)
