"""The scheme delta-beam: a forward-scaled beam per ordinate, and one diffusion solve.

See `maths.delta_beam` for the method.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...gpu.commands import Commands
from ...gpu.memory import Buffer
from ...maths.ordinates import Ordinates, parallel
from ...maths.transforms import F64
from ...scene.lights import Light
from ..grids.grids import GridLights
from ..grids.propagation import GridPropagation
from ..light.incident import IncidentLight
from ..light.table import LocalLight
from ..light.visibility import Surfaces
from ..light.walls import Walls
from ..medium.finer_medium import FinerMedium
from ..medium.grid_medium import GridMedium, ScatteredLight
from ..medium.mixture import Mixture
from ..medium.placement import MediumParams
from ..settings import PopSettings, uses_virtual_grids
from .border import Border
from .deposit import Deposit
from .diffuse import Diffuse
from .emission import Emission
from .near_light import NearLight


class DeltaBeams:
    """The light of one medium: `light` in its cells, of which `diffuse` is what left the beams."""

    iterations = 0
    """Propagation steps from cell to cell: none."""
    has_mean = True

    def __init__(
        self,
        medium: GridMedium,
        settings: PopSettings,
        capacity: int,
        mixture: Mixture,
        *,
        indirect: Buffer | None = None,
        takes_others: bool = False,
        outer: DeltaBeams | None = None,
    ) -> None:
        """For at most `capacity` ordinates.

        `outer`: of a finer grid, the light of the next larger one, which enters at its border.

        `takes_others`: whether light of the other media in `mixture` arrives, and this light is
        what they receive; else the world ends at the medium's box. `indirect`: where virtual
        point lights in grids leave the radiance that the eye sees of them.
        """
        self._medium, self._settings, self._indirect = medium, settings, indirect
        # What arrives, what of it leaves the beams, and where that spreads.
        self.light = IncidentLight(medium, mixture, settings, capacity, takes_others=takes_others)
        self.diffuse = Diffuse(medium.gpu, medium.placement, mixture)
        self._deposit = Deposit(medium, self.light)
        self._border: Border | None = None
        if outer is not None and isinstance(medium, FinerMedium):
            self._border = Border(medium, mixture, outer.diffuse)
        self._near = NearLight(medium, self.light)
        self._walls: Walls | None = None
        self._surfaces: Surfaces | None = None
        # Virtual point lights may propagate in grids of their own.
        self._in_grids = uses_virtual_grids(settings, alone=mixture.is_alone)
        self._virtual_grids: GridPropagation | None = None
        self._propagated_for = b""  # the eye
        self._has_local_lights = False
        self._sends = takes_others
        if takes_others:
            medium.scattered = ScatteredLight(self.diffuse.deposits, self.diffuse.diffuse)

    def write(
        self,
        ordinates: Ordinates,
        local: Sequence[LocalLight],
        scale: float = 0.0,
        *,
        virtual: int = 0,
    ) -> None:
        """Upload the light of a frame; `scale` as in `OrdinateTable.write`.

        The last `virtual` of `local` are virtual point lights, which the device overwrites.
        """
        medium, table = self._medium, self.light.table
        # Close to local lights, though not to virtual ones, beams and diffusion miss light.
        self._has_local_lights = len(local) > virtual
        if local:
            self._near.write(medium.volume.g, medium.albedo)
        self.light.write(ordinates, local, scale)
        # Other media receive this light in the unit in which it is stored.
        if self._sends:
            self._medium.scattered.scale = table.scale
        if virtual and self._in_grids:
            self._write_virtual_grids(virtual)

    def _write_virtual_grids(self, virtual: int) -> None:
        """Place a grid for each of the last `virtual` ordinates."""
        # Grids of virtual lights alone; their light is added to what the beams leave.
        table = self.light.table
        if self._virtual_grids is None:
            self._virtual_grids = GridPropagation(
                self._medium, self._settings, virtual, merged=self._indirect, is_added=True
            )
        first_row = table.count - virtual
        self._virtual_grids.write(
            GridLights(parallel([], []), (), table.scale, virtual=virtual, first_row=first_row)
        )

    def write_surfaces(
        self, ordinates: Ordinates, lights: tuple[Light, ...], surfaces: Surfaces
    ) -> None:
        """Take the surfaces that shade the medium, with the lights of the scene."""
        self.light.write_surfaces(ordinates, lights, surfaces, in_grids=self._in_grids)
        self._surfaces = surfaces
        self._walls = self._walls or Walls(self._medium)

    def encode_medium(self, commands: Commands, params: MediumParams) -> None:
        """Take a changed medium: the operator of the diffusion solve."""
        # Surfaces between this medium and others depend on where it is.
        self.light.forget()
        self.diffuse.encode_medium(commands, params, self._medium.density.cells)

    def encode(self, commands: Commands, params: MediumParams, eye: F64 | None = None) -> None:
        """Solve the light of the scene; `eye` (3,), m in the frame of the medium, if any."""
        # Surfaces between cells close faces of the operator.
        walls, surfaces = self._walls, self._surfaces
        is_new = walls and surfaces and walls.encode(commands, params, surfaces, self.diffuse.walls)
        if is_new:
            self.diffuse.encode_medium(commands, params, self._medium.density.cells)
        # Blocks of other media are positioned; they are dark until those are solved.
        self.light.encode_others(commands, is_lit=False)
        # Media and surfaces between every cell and every ordinate.
        self.light.encode(commands, params)
        if self._virtual_grids is not None:
            with commands.stage("pop initialisation"):
                self._virtual_grids.encode_grids(commands, params, self.light.table.rows)
        # Power that leaves the beams, and where it spreads.
        self._scatter(commands, params, eye)

    def encode_others(self, commands: Commands) -> None:
        """Solve again, with the light that other media scatter as they are solved."""
        # The blocks were positioned by `encode`; now they are lit.
        if self.light.blocks:
            self.light.encode_others(commands, is_lit=True)
            self._scatter(commands, self._medium.params)

    def _scatter(self, commands: Commands, params: MediumParams, eye: F64 | None = None) -> None:
        """Deposit power from the beams in the cells, and solve for the diffuse light."""
        with commands.stage("pop deposit"):
            self._deposit.encode(commands, params, self.diffuse.deposits)
        if self._virtual_grids is not None and eye is not None:
            self._propagate_virtual(commands, params, eye)
        with commands.stage("pop diffuse"):
            density, steps = self._medium.density.cells, self._settings.solver_steps
            # The larger grid's diffuse light enters: power before the solve, net flux after it.
            if self._border is not None:
                self._border.encode_power(commands, params, self.diffuse.deposits)
            self.diffuse.encode(commands, params, density, steps)
            if self._border is not None:
                self._border.encode_flux(commands, params, self.diffuse.diffuse)
            # Close to local lights the cells are too coarse for both.
            if self._has_local_lights:
                self._near.encode(commands, params, self.diffuse.diffuse)

    def _propagate_virtual(self, commands: Commands, params: MediumParams, eye: F64) -> None:
        """Virtual point lights in grids: added to the deposits, and the radiance to `eye`."""
        assert self._virtual_grids is not None
        self._propagated_for = eye.tobytes()
        self._virtual_grids.encode(commands, params, self.light, eye, self.diffuse.deposits)

    def encode_view(
        self, commands: Commands, params: MediumParams, eye: F64, emission: Emission
    ) -> None:
        """Fill `emission` for an eye at `eye` (3,), m in the frame of the medium."""
        # Light in grids is summed for one eye, so another eye propagates it again.
        if self._virtual_grids is not None and eye.tobytes() != self._propagated_for:
            self._propagate_virtual(commands, params, eye)
        with commands.stage("pop emission"):
            emission.encode(commands, params, eye, self.light, self.diffuse)
