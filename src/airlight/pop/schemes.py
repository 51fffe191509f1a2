"""How ordinates' light spreads in one medium: beams with diffusion, or hops from cell to cell.

delta-beam  a forward-scaled beam per ordinate, one diffusion solve; see `maths.delta_beam`
split       hops in a grid per ordinate, their isotropic residuum solved; see `maths.ordinate_hops`
paper       Elek2014 as printed, for its figures: measured 3 to 17 times too bright
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..maths.ordinate_hops import switch_iteration
from ..maths.ordinates import Ordinates
from ..maths.transforms import F64
from ..scene.lights import Light
from ..scene.volume import Volume
from .density import Density
from .deposit import Deposit
from .diffuse import Diffuse
from .emission import Emission
from .given import Given
from .hop_emission import HopEmission, Isotropic, bound_emission
from .hop_grids import HopGrids
from .hop_merge import Merge
from .mixture import Mix
from .near_light import NearLight
from .ordinates import Lamp, OrdinateTable
from .paths import Paths
from .placement import MediumParams
from .propagate import Propagate
from .virtual_lights import VirtualLights
from .visibility import Surfaces, Visibility

if TYPE_CHECKING:
    from .solver import PopSolver

SCHEMES = ("delta-beam", "split", "paper")


class Beams:
    """Ordinates of one sky in one medium, marched and solved: the scheme delta-beam."""

    def __init__(
        self, gpu: Gpu, solver: PopSolver, capacity: int, mix: Mix, *, takes_others: bool = False
    ) -> None:
        """`takes_others`: whether light of the others in `mix` is more ordinates; else the world
        ends at the medium's box.
        """
        self.mix = mix
        self.blocks = mix.blocks if takes_others else 0
        self.table = OrdinateTable(gpu, capacity + self.blocks)
        self.paths = Paths(gpu, solver.placement, self.table.capacity, mix)
        self.diffuse = Diffuse(gpu, solver.placement, mix)
        self._deposit = Deposit(gpu, mix, has_blocks=takes_others)
        self._near = NearLight(gpu, mix)
        self._given = Given(gpu, mix) if self.blocks else None
        self._visibility: Visibility | None = None
        self._virtual: VirtualLights | None = None
        self._has_lamps = False
        self._solver = solver

    def write(
        self, ordinates: Ordinates, lamps: Sequence[Lamp], volume: Volume, scale: float = 0.0
    ) -> None:
        """Upload the light; `scale` as in `OrdinateTable.write`."""
        s = self._solver
        self._has_lamps = bool(lamps)
        if lamps:
            self._near.write(volume.g, volume.albedo)
        self.table.write(ordinates, lamps, s.placement, volume.g,
                         prefilter=s.settings.prefilter, scale=scale,
                         blocks=self.blocks)  # fmt: skip

    def write_surfaces(
        self, ordinates: Ordinates, lights: tuple[Light, ...], surfaces: Surfaces
    ) -> None:
        """Take what shades the medium, with the light of the scene."""
        if self._visibility is None:
            self._visibility = Visibility(self._solver.gpu, self.table.capacity)
        self._visibility.write(ordinates, lights, surfaces.sky,
                               surfaces.virtual_lights + self.blocks)  # fmt: skip
        self._surfaces = surfaces
        if self._virtual is None and surfaces.reflected is not None:
            self._virtual = VirtualLights(self._solver.gpu, surfaces.reflected)

    def encode_medium(self, commands: Commands, params: MediumParams, density: Density) -> None:
        """Take a changed medium."""
        self.diffuse.encode_medium(commands, params, density.cells)

    def encode(self, commands: Commands, params: MediumParams, density: Density) -> None:
        """March to the light, deposit, solve."""
        if self._given is not None:
            self._take(commands, params, is_lit=False)
        self.encode_paths(commands, params, density)
        self._spread(commands, params, density)

    def encode_given(self, commands: Commands, params: MediumParams, density: Density) -> None:
        """Solve again, with what other media send out as they are solved now."""
        if self._given is not None:
            self._take(commands, params, is_lit=True)
            self._spread(commands, params, density)

    def _take(self, commands: Commands, params: MediumParams, *, is_lit: bool) -> None:
        assert self._given is not None
        with commands.stage("pop other media"):
            self._given.encode(commands, self._solver, params, self.table.count,
                               self._solver.others, is_lit=is_lit)  # fmt: skip

    def _spread(self, commands: Commands, params: MediumParams, density: Density) -> None:
        with commands.stage("pop deposit"):
            self._deposit.encode(
                commands, params, self._solver.placement.cells, ordinates=self.table.rows,
                passed=self.paths.passed, density=density.cells, deposits=self.diffuse.deposits,
            )  # fmt: skip
        with commands.stage("pop diffuse"):
            self.diffuse.encode(commands, params, density.cells,
                                self._solver.settings.solver_steps)  # fmt: skip
            if self._has_lamps:
                self._near.encode(
                    commands, params, self._solver.placement.cells, ordinates=self.table.rows,
                    passed=self.paths.passed, diffuse=self.diffuse.diffuse,
                )  # fmt: skip

    def encode_paths(self, commands: Commands, params: MediumParams, density: Density) -> None:
        """March to the light from every cell."""
        placement, virtual = self._solver.placement, self._virtual
        if virtual is not None:
            first = self.table.count - self._surfaces.virtual_lights - self.blocks
            with commands.stage("pop virtual lights"):
                virtual.encode(commands, placement, self.table.rows, first, self.table.scale)
        with commands.stage("pop paths"):
            self.paths.encode(
                commands, params, self.table.rows, self.table.count, density,
                self._solver.others, is_closed=not self.blocks,
            )  # fmt: skip
        if self._visibility is not None:
            with commands.stage("pop visibility"):
                self._visibility.encode(
                    commands, params, placement, self.table.count, self._surfaces,
                    reach=density.reach, passed=self.paths.passed,
                )  # fmt: skip
        if virtual is not None:
            with commands.stage("pop visibility"):
                virtual.encode_sight(commands, params, placement, reach=density.reach,
                                     passed=self.paths.passed)  # fmt: skip

    def encode_view(
        self, commands: Commands, params: MediumParams, eye: F64, emission: Emission,
        density: Density,
    ) -> None:  # fmt: skip
        """What is seen from `eye` (3,), m in the medium's frame."""
        with commands.stage("pop emission"):
            emission.encode(
                commands, params, eye, self.table, self.paths.passed, self.diffuse.diffuse,
                density.reach, self._solver.settings.furnace_correction,
            )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        for part in (
            self.table,
            self.paths,
            self.diffuse,
            self._near,
            self._given,
            self._visibility,
            self._virtual,
        ):
            if part is not None:
                part.release()


class HoppingBeams(Beams):
    """The schemes split and paper: what lobes scatter is summed for one eye while they hop."""

    def __init__(
        self, gpu: Gpu, solver: PopSolver, capacity: int, mix: Mix, *, takes_others: bool = False
    ) -> None:
        super().__init__(gpu, solver, capacity, mix)
        settings = solver.settings
        self.is_paper = settings.scheme == "paper"
        self.grids = HopGrids(gpu, solver.placement, settings.grid, self.table.capacity)
        self.hopping = Propagate(gpu, self.grids.capacity, self.table.capacity)
        self.merge = Merge(gpu, solver.placement)
        self.isotropic = Isotropic(gpu, solver.placement) if self.is_paper else None
        self.iterations = settings.iterations
        self._emission = HopEmission(gpu)

    def write(
        self, ordinates: Ordinates, lamps: Sequence[Lamp], volume: Volume, scale: float = 0.0
    ) -> None:
        """Upload the light and place its grids."""
        super().write(ordinates, lamps, volume, scale)
        s = self._solver
        self.grids.write(ordinates, lamps, s.placement, prefilter=s.settings.prefilter,
                         scale=self.table.scale)  # fmt: skip
        if self.is_paper and s.settings.residuum:
            self.iterations = self._switch(volume)

    def encode(self, commands: Commands, params: MediumParams, density: Density) -> None:
        """March to the light, fill the grids with air."""
        self.encode_paths(commands, params, density)
        with commands.stage("pop initialisation"):
            hops = self.grids.params((0.0, 0.0, 0.0), is_paper=self.is_paper)
            self.grids.encode(commands, params, hops, density)

    def encode_view(
        self, commands: Commands, params: MediumParams, eye: F64, emission: Emission,
        density: Density,
    ) -> None:  # fmt: skip
        """Propagate, merge, solve for the residuum."""
        hops = self.grids.params(eye, is_paper=self.is_paper)
        with commands.stage("pop initialisation"):
            self.hopping.encode_begin(commands, params, self.grids, self.table.rows,
                                      self.paths.passed, eye, is_paper=self.is_paper)  # fmt: skip
        with commands.stage("pop propagation"):
            self.hopping.encode(commands, params, self.grids, eye, self.iterations,
                                is_paper=self.is_paper)  # fmt: skip
        with commands.stage("pop merge"):
            self.merge.encode(commands, params, hops, self.grids, self.hopping.gathered,
                              density.cells, self.diffuse.deposits)  # fmt: skip
        with commands.stage("pop residuum"):
            self._encode_residuum(commands, params, density)
        with commands.stage("pop emission"):
            bound = bound_emission(
                params, hops, self.table, eye, self.paths.passed, self.diffuse.diffuse,
                density.reach, self.merge.merged, emission.texture,
            )  # fmt: skip
            self._emission.encode(commands, emission.cells, **bound)

    def release(self) -> None:
        """Give the memory back."""
        super().release()
        for part in (self.grids, self.hopping, self.merge, self.isotropic):
            if part is not None:
                part.release()

    def _encode_residuum(self, commands: Commands, params: MediumParams, density: Density) -> None:
        settings = self._solver.settings
        if self.isotropic is None:
            self.diffuse.encode(commands, params, density.cells, settings.solver_steps)
            return
        hops = settings.residuum_iterations if settings.residuum else 0
        self.isotropic.encode(commands, params, self._solver.placement, density.cells,
                              self.diffuse.deposits, self.diffuse.diffuse, hops)  # fmt: skip

    def _switch(self, volume: Volume) -> int:
        """Hops before the residuum is isotropic enough to hop in the medium's own cells."""
        settings, s = self._solver.settings, self._solver
        spacing = float(s.placement.cell.mean())
        wanted = max(
            switch_iteration(1.0, g, sigma_t * albedo * s.mean_density, spacing)
            for g, sigma_t, albedo in zip(volume.g, volume.sigma_t, volume.albedo, strict=True)
        )
        return int(min(max(1.0, math.ceil(wanted) if wanted < 1e6 else 1e6), settings.iterations))
