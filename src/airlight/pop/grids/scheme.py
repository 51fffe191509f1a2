"""The schemes split and paper: light propagates in a grid per ordinate.

split   as corrected, its isotropic residuum solved by diffusion; see `maths.ordinate_hops`
paper   Elek2014 as printed, for its figures: measured 3 to 17 times too bright
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...gpu.commands import Commands
from ...maths.ordinate_hops import switch_iteration
from ...maths.ordinates import Ordinates
from ...maths.transforms import F64
from ...scene.lights import Light
from ..delta.diffuse import Diffuse
from ..delta.emission import Emission
from ..light.incident import IncidentLight
from ..light.table import LocalLight
from ..light.visibility import Surfaces
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams
from ..settings import PopSettings
from .emission import GridEmission
from .grids import GridLights
from .propagation import GridPropagation
from .residuum import Residuum


class OrdinateGrids:
    """The light of one medium, which knows no other one; see `solver.Transport`.

    The radiance that lobes scatter towards the eye is summed while they propagate, so most of the
    work is done in `encode_view`.
    """

    has_mean = False

    def __init__(self, medium: GridMedium, settings: PopSettings, capacity: int) -> None:
        """For at most `capacity` ordinates."""
        self._medium, self._settings, mixture = medium, settings, medium.mixture
        # Light that reaches the cells unscattered, and where the residuum of the grids goes.
        self.light = IncidentLight(medium, mixture, settings, capacity)
        self.diffuse = Diffuse(medium.gpu, medium.placement, mixture)
        # The grids of ordinates, and for the scheme paper a residuum of its own.
        is_paper = settings.scheme == "paper"
        most = self.light.table.capacity
        self.propagation = GridPropagation(medium, settings, most, is_paper=is_paper)
        self._residuum = Residuum(medium) if is_paper else None
        self._emission = GridEmission(medium, self.propagation)

    @property
    def iterations(self) -> int:
        """Propagation steps from cell to cell."""
        return self.propagation.iterations

    def write(
        self,
        ordinates: Ordinates,
        local: Sequence[LocalLight],
        scale: float = 0.0,
        *,
        virtual: int = 0,
    ) -> None:
        """Upload the light of a frame; see `DeltaBeams.write`."""
        self.light.write(ordinates, local, scale)
        # The host places the grids of the lights that it knows; virtual ones follow on the device.
        known = local[: len(local) - virtual]
        self.propagation.write(
            GridLights(ordinates, known, self.light.table.scale, virtual=virtual)
        )
        # As printed, light propagates until it is isotropic enough for the shared grid.
        if self._residuum is not None and self._settings.residuum:
            self.propagation.iterations = self._switch_iteration()

    def write_surfaces(
        self, ordinates: Ordinates, lights: tuple[Light, ...], surfaces: Surfaces
    ) -> None:
        """Take the surfaces that shade the medium, with the lights of the scene."""
        self.light.write_surfaces(ordinates, lights, surfaces, in_grids=True)

    def encode_medium(self, commands: Commands, params: MediumParams) -> None:
        """Take a changed medium: the operator of the diffusion solve."""
        self.diffuse.encode_medium(commands, params, self._medium.density.cells)

    def encode(self, commands: Commands, params: MediumParams, eye: F64 | None = None) -> None:
        """Compute what reaches the cells, and the density in the grids; `eye` does not matter."""
        self.light.encode(commands, params)
        with commands.stage("pop initialisation"):
            self.propagation.encode_grids(commands, params, self.light.table.rows)

    def encode_others(self, commands: Commands) -> None:
        """Do nothing: no light of other media arrives."""

    def encode_view(
        self, commands: Commands, params: MediumParams, eye: F64, emission: Emission
    ) -> None:
        """Propagate, merge, solve for the residuum, and fill `emission` for an eye at `eye`."""
        # What the eye sees is summed on the way, so every view propagates again.
        self.propagation.encode(commands, params, self.light, eye, self.diffuse.deposits)
        with commands.stage("pop residuum"):
            self._encode_residuum(commands, params)
        with commands.stage("pop emission"):
            diffuse = self.diffuse.diffuse
            self._emission.encode(commands, params, eye, self.light, diffuse, emission)

    def _encode_residuum(self, commands: Commands, params: MediumParams) -> None:
        """Spread the residuum: by diffusion, or isotropically from cell to cell as printed."""
        settings, diffuse = self._settings, self.diffuse
        if self._residuum is None:
            density = self._medium.density.cells
            diffuse.encode(commands, params, density, settings.solver_steps)
            return
        steps = settings.residuum_iterations if settings.residuum else 0
        self._residuum.encode(commands, params, diffuse.deposits, diffuse.diffuse, steps)

    def _switch_iteration(self) -> int:
        """Steps after which light is isotropic enough for the residuum (Elek2014 eq. 10)."""
        volume, density = self._medium.volume, self._medium.placed.width.density
        spacing = float(self._medium.placement.cell.mean())
        # The channel that stays anisotropic longest decides; the setting bounds the steps.
        wanted = max(
            switch_iteration(1.0, g, sigma_t * albedo * density, spacing)
            for g, sigma_t, albedo in zip(volume.g, volume.sigma_t, volume.albedo, strict=True)
        )
        steps = max(1.0, math.ceil(wanted) if wanted < 1e6 else 1e6)
        return int(min(steps, self._settings.iterations))
