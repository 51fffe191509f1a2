"""Diffuse light in the cells of a medium: conjugate gradients with a fixed number of steps.

A step is two dispatches. Dot products leave one partial sum per workgroup, which every workgroup of
the next dispatch adds up in the same order: nothing is read back, no atomics are needed, and the
bits are reproducible. The preconditioner is the diagonal of the operator. See `maths.diffusion`.
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32
from ...gpu.memory import Buffer
from ...gpu.slots import Slot, storage, uniform
from ..medium.mixture import Mixture
from ..medium.placement import PARTIAL_SUM_GROUP, MediumParams, MediumPlacement

_VECTORS = 4  # deposits and diffuse light: [P, Bx, By, Bz], [Phi, Jx, Jy, Jz]
_OUTGOING = 3  # what of diffuse light goes towards the eye, see `outgoing`


class StepParams(Struct):
    """Which step of the conjugate gradients this is."""

    step = u32()


# What several steps of the solve bind; sums are over a workgroup's cells.
_params = uniform("params", MediumParams)
_density, _links = storage("density", "f32"), storage("links", "vec4f")
_walls = storage("walls", "u32")
_sums = storage("sums", "vec4f", "read_write")


class _OfCells(ComputePass):
    """A pass that reads the coefficients of cells."""

    own_slots: tuple[Slot, ...]

    def __init__(self, gpu: Gpu, mixture: Mixture) -> None:
        self.slots = (*self.own_slots, *mixture.cell_slots)
        super().__init__(gpu, generated=mixture.cell_wgsl)


class _System(_OfCells):
    """The operator: its diagonal, and the links to the next cells along x, y, z; m^-1.

    Behind them it leaves which faces of the cell surfaces close, and what those reflect.
    """

    own_slots = (_params, _density, _walls, storage("links", "vec4f", "read_write"))
    workgroup = (64, 1, 1)
    file = "diffuse_system.wgsl"


class _Begin(_OfCells):
    """r = b, z = b/diagonal, phi = 0; sums r.z."""

    own_slots = (
        _params,
        _density,
        _links,
        storage("deposits", "vec4f"),
        storage("residual", "vec4f", "read_write"),
        storage("z", "vec4f", "read_write"),
        storage("phi", "vec4f", "read_write"),
        _sums,
    )
    workgroup = (PARTIAL_SUM_GROUP, 1, 1)
    file = "diffuse_begin.wgsl"


class _Search(ComputePass):
    """p = z + beta p (z in the first step), and A p; sums p.Ap."""

    slots = (
        _params,
        _links,
        uniform("iteration", StepParams),
        storage("z", "vec4f"),
        storage("before", "vec4f"),
        storage("search", "vec4f", "read_write"),
        storage("product", "vec4f", "read_write"),
        _sums,
    )
    workgroup = (PARTIAL_SUM_GROUP, 1, 1)
    file = "diffuse_search.wgsl"


class _Update(ComputePass):
    """phi += alpha p, r -= alpha A p, z = r/diagonal; sums r.z."""

    slots = (
        _params,
        _links,
        uniform("iteration", StepParams),
        storage("search", "vec4f"),
        storage("product", "vec4f"),
        storage("phi", "vec4f", "read_write"),
        storage("residual", "vec4f", "read_write"),
        storage("z", "vec4f", "read_write"),
        _sums,
    )
    workgroup = (PARTIAL_SUM_GROUP, 1, 1)
    file = "diffuse_update.wgsl"


class _Flux(_OfCells):
    """The flux J at cell centres, from phi and the net power that the deposits carry."""

    own_slots = (
        _params,
        _density,
        _links,
        storage("deposits", "vec4f"),
        storage("phi", "vec4f"),
        storage("diffuse", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "diffuse_flux.wgsl"


class Diffuse:
    """The diffuse light of one medium.

    In: `deposits`, vec4 [P, Bx, By, Bz][z][y][x], W. Out: `diffuse`, vec4 [Phi, Jx, Jy,
    Jz][z][y][x], W m^-2; both rgb. For an eye `outgoing` adds to the latter what goes there.
    `walls`: surfaces between cells, as `wgsl/walls.wgsl` reads them; none until they are filled.
    """

    def __init__(self, gpu: Gpu, placement: MediumPlacement, mixture: Mixture) -> None:
        self.cells, self._mixture = placement.cells, mixture
        nbytes = 16 * self.cells
        self.deposits = Buffer(gpu, "deposits", _VECTORS * nbytes)
        self.diffuse = Buffer(gpu, "diffuse light", (_VECTORS + _OUTGOING) * nbytes)
        # Vectors of the conjugate gradients; a step reads the search direction before its own.
        names = ("phi", "residual", "z", "search 0", "search 1", "product")
        self._vectors = {name: Buffer(gpu, f"diffusion {name}", nbytes) for name in names}
        # The operator of the medium, and the surfaces between its cells.
        self._links = Buffer(gpu, "diffusion links", _VECTORS * nbytes)
        self.walls = Buffer(gpu, "walls between cells", 8 * self.cells)
        # One partial sum per workgroup, of three dot products: r.z of two steps, and p.Ap.
        self._sums = Buffer(gpu, "diffusion sums", 3 * 16 * -(-self.cells // PARTIAL_SUM_GROUP))
        self._system, self._flux = _System(gpu, mixture), _Flux(gpu, mixture)
        self._begin, self._search, self._update = _Begin(gpu, mixture), _Search(gpu), _Update(gpu)

    def encode_medium(self, commands: Commands, params: MediumParams, density: Buffer) -> None:
        """Compute the operator of a medium, whose number of ordinates does not matter."""
        # Links between cells depend on the medium alone, and serve every light.
        self._system.dispatch(
            commands,
            (self.cells,),
            params=params,
            density=density,
            walls=self.walls,
            links=self._links,
            **self._mixture.cell_bound,
        )

    def encode(self, commands: Commands, params: MediumParams, density: Buffer, steps: int) -> None:
        """Solve for `deposits` in so many `steps` of conjugate gradients."""
        v, cells = self._vectors, (self.cells,)
        common = {"params": params, "links": self._links, "sums": self._sums, "z": v["z"]}
        # r = b, z = r/diagonal, phi = 0.
        self._begin.dispatch(
            commands,
            cells,
            **common,
            density=density,
            deposits=self.deposits,
            residual=v["residual"],
            phi=v["phi"],
            **self._mixture.cell_bound,
        )
        # The number of steps is fixed: no residual is read back.
        for step in range(steps):
            self._step(commands, step, common)
        # Fluence and net flux from phi.
        self._flux.dispatch(
            commands,
            cells,
            params=params,
            density=density,
            links=self._links,
            deposits=self.deposits,
            phi=v["phi"],
            diffuse=self.diffuse,
            **self._mixture.cell_bound,
        )

    def _step(self, commands: Commands, step: int, common: dict[str, Any]) -> None:
        """Search along p = z + beta p; then phi += alpha p and r -= alpha A p."""
        v, cells = self._vectors, (self.cells,)
        # The two search directions change roles from step to step.
        before, search = v[f"search {step % 2}"], v[f"search {1 - step % 2}"]
        shared = {
            **common,
            "iteration": StepParams(step=step),
            "search": search,
            "product": v["product"],
        }
        self._search.dispatch(commands, cells, **shared, before=before)
        self._update.dispatch(commands, cells, **shared, phi=v["phi"], residual=v["residual"])

    @property
    def phi(self) -> Buffer:
        """The solution, W m^-2, vec4 per cell: the fluence before it is clamped at 0."""
        return self._vectors["phi"]

    @property
    def residual(self) -> Buffer:
        """The residual b - A phi of the last solve, W m^-3, vec4 per cell."""
        return self._vectors["residual"]
