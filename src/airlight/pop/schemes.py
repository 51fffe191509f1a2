"""How ordinates' light spreads in one medium: beams with diffusion, or hops from cell to cell.

delta-beam  a forward-scaled beam per ordinate, one diffusion solve; see `maths.delta_beam`
split       hops in a grid per ordinate, their isotropic residuum solved; see `maths.ordinate_hops`
paper       Elek2014 as printed, for its figures: measured 3 to 17 times too bright
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..gpu.commands import Commands
from ..gpu.memory import Buffer
from ..maths.ordinate_hops import switch_iteration
from ..maths.ordinates import Ordinates, parallel
from ..maths.transforms import F64
from ..scene.lights import Light
from .delta.deposit import Deposit
from .delta.diffuse import Diffuse
from .delta.emission import Emission
from .delta.near_light import NearLight
from .exchange.irradiance import Given
from .grids.emission import HopEmission, Isotropic, bound_emission
from .grids.propagation import Hopping
from .light.ordinates import Lamp, OrdinateTable
from .light.paths import Paths
from .light.visibility import Surfaces, Visibility
from .medium.grid_medium import GridMedium, Sent
from .medium.mixture import Mix
from .medium.placement import MediumParams
from .settings import PopSettings
from .virtual.grids import is_hopping
from .virtual.lights import VirtualLights


class Beams:
    """Ordinates of one sky in one medium, marched and solved: the scheme delta-beam."""

    def __init__(
        self,
        medium: GridMedium,
        settings: PopSettings,
        capacity: int,
        mix: Mix,
        *,
        bounced: Buffer | None = None,
        takes_others: bool = False,
    ) -> None:
        """`takes_others`: whether light of the others in `mix` is more ordinates, and this light
        is what they are sent; else the world ends at the medium's box. `bounced`: where virtual
        lights that hop leave what is seen of them.
        """
        gpu = medium.gpu
        self.mix, self._medium, self._settings, self._bounced = mix, medium, settings, bounced
        self.blocks = mix.blocks if takes_others else 0
        self.table = OrdinateTable(gpu, capacity + self.blocks)
        self.paths = Paths(gpu, medium.placement, self.table.capacity, mix)
        self.diffuse = Diffuse(gpu, medium.placement, mix)
        self._deposit = Deposit(gpu, mix, has_blocks=takes_others)
        self._near = NearLight(gpu, mix)
        self._given = Given(gpu, mix) if self.blocks else None
        self._visibility: Visibility | None = None
        self._virtual: VirtualLights | None = None
        self._virtual_hops: Hopping | None = None
        self._hopped_for = b""
        self._surfaces: Surfaces | None = None
        self._has_lamps = False
        self._takes_others = takes_others
        if takes_others:
            medium.sent = Sent(self.diffuse.deposits, self.diffuse.diffuse)

    def write(
        self, ordinates: Ordinates, lamps: Sequence[Lamp], scale: float = 0.0, *, virtual: int = 0
    ) -> None:
        """Upload the light; `scale` as in `OrdinateTable.write`. The last `virtual` of `lamps` are
        virtual lights, which are written on the device.
        """
        volume = self._medium.volume
        self._has_lamps = len(lamps) > virtual
        if lamps:
            self._near.write(volume.g, volume.albedo)
        self.table.write(
            ordinates,
            lamps,
            self._medium.placement,
            volume.g,
            prefilter=self._settings.prefilter,
            scale=scale,
            blocks=self.blocks,
        )
        if self._takes_others:
            self._medium.sent.scale = self.table.scale
        self._place(ordinates, lamps[: len(lamps) - virtual], virtual)

    def _place(self, ordinates: Ordinates, lamps: Sequence[Lamp], virtual: int) -> None:
        """Grids of virtual lights, where these hop."""
        medium, settings = self._medium, self._settings
        if virtual and is_hopping(settings, alone=self.mix.is_alone):
            self._virtual_hops = self._virtual_hops or Hopping(
                medium.gpu, medium.placement, settings.grid, virtual, merged=self._bounced
            )
            self._virtual_hops.write(
                parallel([], []),
                (),
                medium.placement,
                prefilter=settings.prefilter,
                scale=self.table.scale,
                virtual=virtual,
                first_row=self.table.count - virtual,
            )

    def write_surfaces(
        self, ordinates: Ordinates, lights: tuple[Light, ...], surfaces: Surfaces
    ) -> None:
        """Take what shades the medium, with the light of the scene."""
        if self._visibility is None:
            self._visibility = Visibility(self._medium.gpu, self.table.capacity)
        self._visibility.write(
            ordinates, lights, surfaces.sky, surfaces.virtual_lights + self.blocks
        )
        self._surfaces = surfaces
        if self._virtual is None and surfaces.reflected is not None:
            hops = is_hopping(self._settings, alone=self.mix.is_alone)
            self._virtual = VirtualLights(self._medium.gpu, surfaces.reflected, are_hopping=hops)

    def encode_medium(self, commands: Commands, params: MediumParams) -> None:
        """Take a changed medium."""
        if self._given is not None:
            self._given.forget()
        self.diffuse.encode_medium(commands, params, self._medium.density.cells)

    def encode(self, commands: Commands, params: MediumParams, eye: F64 | None = None) -> None:
        """March to the light, deposit, solve. `eye` (3,), m in the medium's frame, if any."""
        if self._given is not None:
            self._take(commands, is_lit=False)
        self.encode_paths(commands, params)
        if self._virtual_hops is not None:
            with commands.stage("pop initialisation"):
                self._virtual_hops.encode_grids(
                    commands, params, self.table.rows, self._medium.density
                )
        self._spread(commands, params, eye)

    def encode_given(self, commands: Commands) -> None:
        """Solve again, with what other media send out as they are solved now."""
        if self._given is not None:
            self._take(commands, is_lit=True)
            self._spread(commands, self._medium.params)

    def _take(self, commands: Commands, *, is_lit: bool) -> None:
        assert self._given is not None
        with commands.stage("pop other media"):
            self._given.encode(commands, self._medium, self.table, self._surfaces, is_lit=is_lit)

    def _hop(self, commands: Commands, params: MediumParams, eye: F64) -> None:
        """Light of virtual lights that hop: added to the deposits, and what `eye` sees of it."""
        assert self._virtual_hops is not None
        self._hopped_for = eye.tobytes()
        self._virtual_hops.encode(
            commands,
            params,
            self.table,
            self.paths.passed,
            self._medium.density,
            self.diffuse.deposits,
            eye,
            self._settings.iterations,
            is_added=True,
        )

    def _spread(self, commands: Commands, params: MediumParams, eye: F64 | None = None) -> None:
        cells, density = self._medium.placement.cells, self._medium.density
        with commands.stage("pop deposit"):
            self._deposit.encode(
                commands,
                params,
                cells,
                ordinates=self.table.rows,
                passed=self.paths.passed,
                density=density.cells,
                deposits=self.diffuse.deposits,
            )
        if self._virtual_hops is not None and eye is not None:
            self._hop(commands, params, eye)
        with commands.stage("pop diffuse"):
            self.diffuse.encode(commands, params, density.cells, self._settings.solver_steps)
            if self._has_lamps:
                self._near.encode(
                    commands,
                    params,
                    cells,
                    ordinates=self.table.rows,
                    passed=self.paths.passed,
                    diffuse=self.diffuse.diffuse,
                )

    def encode_paths(self, commands: Commands, params: MediumParams) -> None:
        """March to the light from every cell."""
        placement, density = self._medium.placement, self._medium.density
        virtual, surfaces = self._virtual, self._surfaces
        if virtual is not None and surfaces is not None:
            first = self.table.count - surfaces.virtual_lights - self.blocks
            with commands.stage("pop virtual lights"):
                virtual.encode(commands, placement, self.table.rows, first, self.table.scale)
        with commands.stage("pop paths"):
            self.paths.encode(
                commands,
                params,
                self.table.rows,
                self.table.count,
                density,
                self._medium.fine_others,
                is_closed=not self.blocks,
            )
        if self._visibility is not None and surfaces is not None:
            with commands.stage("pop visibility"):
                self._visibility.encode(
                    commands,
                    params,
                    placement,
                    self.table.count,
                    surfaces,
                    reach=density.reach,
                    passed=self.paths.passed,
                )
        if virtual is not None:
            with commands.stage("pop visibility"):
                virtual.encode_sight(
                    commands, params, placement, reach=density.reach, passed=self.paths.passed
                )

    def encode_view(
        self, commands: Commands, params: MediumParams, eye: F64, emission: Emission
    ) -> None:
        """What is seen from `eye` (3,), m in the medium's frame."""
        if self._virtual_hops is not None and eye.tobytes() != self._hopped_for:
            self._hop(commands, params, eye)
        with commands.stage("pop emission"):
            emission.encode(
                commands,
                params,
                eye,
                self.table,
                self.paths.passed,
                self.diffuse.diffuse,
                self._medium.density.reach,
                self._settings.furnace_correction,
            )


class HoppingBeams(Beams):
    """The schemes split and paper: what lobes scatter is summed for one eye while they hop."""

    def __init__(
        self,
        medium: GridMedium,
        settings: PopSettings,
        capacity: int,
        mix: Mix,
        *,
        bounced: Buffer | None = None,
        takes_others: bool = False,
    ) -> None:
        super().__init__(medium, settings, capacity, mix)
        gpu, placement = medium.gpu, medium.placement
        self.is_paper = settings.scheme == "paper"
        self.hopping = Hopping(
            gpu, placement, settings.grid, self.table.capacity, is_paper=self.is_paper
        )
        self.isotropic = Isotropic(gpu, placement) if self.is_paper else None
        self.iterations = settings.iterations
        self._emission = HopEmission(gpu)

    def _place(self, ordinates: Ordinates, lamps: Sequence[Lamp], virtual: int) -> None:
        settings = self._settings
        self.hopping.write(
            ordinates,
            lamps,
            self._medium.placement,
            prefilter=settings.prefilter,
            scale=self.table.scale,
            virtual=virtual,
        )
        if self.is_paper and settings.residuum:
            self.iterations = self._switch()

    def encode(self, commands: Commands, params: MediumParams, eye: F64 | None = None) -> None:
        """March to the light, fill the grids with air."""
        self.encode_paths(commands, params)
        with commands.stage("pop initialisation"):
            self.hopping.encode_grids(commands, params, self.table.rows, self._medium.density)

    def encode_view(
        self, commands: Commands, params: MediumParams, eye: F64, emission: Emission
    ) -> None:
        """Propagate, merge, solve for the residuum."""
        density = self._medium.density
        self.hopping.encode(
            commands,
            params,
            self.table,
            self.paths.passed,
            density,
            self.diffuse.deposits,
            eye,
            self.iterations,
        )
        with commands.stage("pop residuum"):
            self._encode_residuum(commands, params)
        with commands.stage("pop emission"):
            bound = bound_emission(
                params,
                self.hopping.grids.params(eye, is_paper=self.is_paper),
                self.table,
                eye,
                self.paths.passed,
                self.diffuse.diffuse,
                density.reach,
                self.hopping.merge.merged,
                emission.texture,
            )
            self._emission.encode(commands, emission.cells, **bound)

    def _encode_residuum(self, commands: Commands, params: MediumParams) -> None:
        settings, cells = self._settings, self._medium.density.cells
        if self.isotropic is None:
            self.diffuse.encode(commands, params, cells, settings.solver_steps)
            return
        hops = settings.residuum_iterations if settings.residuum else 0
        self.isotropic.encode(
            commands,
            params,
            self._medium.placement,
            cells,
            self.diffuse.deposits,
            self.diffuse.diffuse,
            hops,
        )

    def _switch(self) -> int:
        """Hops before the residuum is isotropic enough to hop in the medium's own cells."""
        volume, density = self._medium.volume, self._medium.placed.width.density
        spacing = float(self._medium.placement.cell.mean())
        wanted = max(
            switch_iteration(1.0, g, sigma_t * albedo * density, spacing)
            for g, sigma_t, albedo in zip(volume.g, volume.sigma_t, volume.albedo, strict=True)
        )
        return int(
            min(max(1.0, math.ceil(wanted) if wanted < 1e6 else 1e6), self._settings.iterations)
        )
