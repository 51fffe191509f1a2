"""The density between every cell and each ordinate.

One dispatch over cells and ordinates marches each path. Elek2014 section 4.1 sweeps a grid that is
aligned with the ordinate; differs: see `maths.delta_beam`.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, u32, vec3f
from ...gpu.memory import Buffer
from ...gpu.slots import sampler, storage, texture, uniform
from ..medium.finer_medium import FinerMedium
from ..medium.grid_medium import GridMedium
from ..medium.mixture import Mixture, fine_bound, fine_slots, fine_wgsl
from ..medium.placement import MediumParams
from .table import OrdinateData, OrdinateTable


class OtherPathParams(Struct):
    """Where other media attenuate."""

    is_closed = u32("1: in the medium's own box only")


class _Others(ComputePass):
    workgroup = (64, 1, 1)
    file = "paths_others.wgsl"

    def __init__(self, gpu: Gpu, mixture: Mixture) -> None:
        self.slots = (
            uniform("params", MediumParams),
            uniform("others", OtherPathParams),
            storage("ordinates", OrdinateData),
            *mixture.cell_slots,
            storage("reach", "u32"),
            *fine_slots(mixture.media - 1),
            sampler("linear_clamp"),
            storage("passed", "f32", "read_write"),
        )
        super().__init__(gpu, generated=fine_wgsl(mixture.media - 1))


class BeyondParams(Struct):
    """The box of the whole medium, in the frame of a finer grid inside it."""

    low = vec3f("m")
    step = f32("m, the longest")
    extent = vec3f("m")


class _Beyond(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("beyond", BeyondParams),
        storage("ordinates", OrdinateData),
        storage("reach", "u32"),
        texture("fine", "3d"),
        sampler("linear_clamp"),
        storage("passed", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "paths_beyond.wgsl"


class Paths(ComputePass):
    """Fills `passed`, f32 [2 * media][ordinate][z][y][x].

    First the medium's own column density, m at density 1, see `maths.voxels.density_behind`; then
    the visibility of the light past surfaces: 1 until `Visibility` overwrites it; then the
    column densities of each other medium, in the medium's own box and beyond it.
    """

    slots = (
        uniform("params", MediumParams),
        storage("ordinates", OrdinateData),
        storage("reach", "u32"),
        texture("fine", "3d"),
        sampler("linear_clamp"),
        storage("passed", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)

    def __init__(self, medium: GridMedium, mixture: Mixture, capacity: int) -> None:
        """For up to `capacity` ordinates."""
        super().__init__(medium.gpu)
        self._medium, self._mixture = medium, mixture
        self._others = None if mixture.is_alone else _Others(medium.gpu, mixture)
        self._beyond = _Beyond(medium.gpu) if isinstance(medium, FinerMedium) else None
        # A column density and a visibility per ordinate and cell; of other media two densities.
        nbytes = 8 * mixture.media * capacity * medium.cells
        self.passed = Buffer(medium.gpu, "density passed", nbytes)

    def encode(
        self, commands: Commands, params: MediumParams, table: OrdinateTable, *, is_closed: bool
    ) -> None:
        """March to every ordinate; past other media beyond the box if not `is_closed`."""
        density = self._medium.density
        extent = (self._medium.cells, max(1, table.count))
        shared = {
            "params": params,
            "ordinates": table.rows,
            "reach": density.reach,
            "linear_clamp": density.linear,
            "passed": self.passed,
        }
        # The medium's own density, then that of the others.
        self.dispatch(commands, extent, **shared, fine=density.fine)
        # From a finer grid, paths go on through the whole medium.
        if self._beyond is not None and isinstance(self._medium, FinerMedium):
            whole = self._medium.whole
            box = BeyondParams(
                low=-self._medium.grid.offset,
                step=float(whole.placement.cell.min()),
                extent=whole.placement.extent,
            )
            own = {**shared, "fine": whole.density.fine}
            self._beyond.dispatch(commands, extent, **own, beyond=box)
        # The other media: in the box and, unless the boundary is closed, beyond it.
        if self._others is not None:
            self._others.dispatch(
                commands,
                extent,
                **shared,
                others=OtherPathParams(is_closed=int(is_closed)),
                **self._mixture.cell_bound,
                **fine_bound(self._medium.fine_others),
            )
