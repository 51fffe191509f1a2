"""Diffuse light in a medium's cells: conjugate gradients with a fixed number of steps.

Two dispatches a step. Dot products leave one partial sum per workgroup, which every workgroup of
the next dispatch adds up again, in the same order: no readback, no atomics, the same bits every
time. The preconditioner is the operator's diagonal. See `maths.diffusion`.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32
from ...gpu.memory import Buffer
from ...gpu.slots import Slot, storage, uniform
from ..medium.mixture import Mix
from ..medium.placement import MediumParams, MediumPlacement

GROUP = 256  # invocations that leave one partial sum
VECTORS = 4  # deposits and flux: [P, Bx, By, Bz], [Phi, Jx, Jy, Jz]


class StepParams(Struct):
    """Which step of the conjugate gradients this is."""

    step = u32()


_params = uniform("params", MediumParams)
_density, _links = storage("density", "f32"), storage("links", "vec4f")
_sums = storage("sums", "vec4f", "read_write")


class _OfCells(ComputePass):
    """A pass that asks what is in cells."""

    own_slots: tuple[Slot, ...]

    def __init__(self, gpu: Gpu, mix: Mix) -> None:
        self.slots = (*self.own_slots, *mix.cell_slots)  # type: ignore[misc]
        super().__init__(gpu, generated=mix.cell_wgsl)


class _System(_OfCells):
    """The operator: its diagonal, and the links to the next cells along x, y, z; m^-1."""

    own_slots = (_params, _density, storage("links", "vec4f", "read_write"))
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
    workgroup = (GROUP, 1, 1)
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
    workgroup = (GROUP, 1, 1)
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
    workgroup = (GROUP, 1, 1)
    file = "diffuse_update.wgsl"


class _Flux(_OfCells):
    """J at cell centres, from phi and what the deposits carry."""

    own_slots = (
        _params,
        _density,
        storage("deposits", "vec4f"),
        storage("phi", "vec4f"),
        storage("diffuse", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "diffuse_flux.wgsl"


class Diffuse:
    """The diffuse light of one medium: `deposits` in, `diffuse` [Phi, Jx, Jy, Jz] out."""

    def __init__(self, gpu: Gpu, placement: MediumPlacement, mix: Mix) -> None:
        self.cells, self._mix = placement.cells, mix
        nbytes = 16 * self.cells
        self.deposits = Buffer(gpu, "deposits", VECTORS * nbytes)
        self.diffuse = Buffer(gpu, "diffuse light", VECTORS * nbytes)
        names = ("phi", "residual", "z", "search 0", "search 1", "product")
        self._vectors = {name: Buffer(gpu, f"diffusion {name}", nbytes) for name in names}
        self._links = Buffer(gpu, "diffusion links", VECTORS * nbytes)
        self._sums = Buffer(gpu, "diffusion sums", 3 * 16 * -(-self.cells // GROUP))
        self._system, self._flux = _System(gpu, mix), _Flux(gpu, mix)
        self._begin, self._search, self._update = _Begin(gpu, mix), _Search(gpu), _Update(gpu)

    def encode_medium(self, commands: Commands, params: MediumParams, density: Buffer) -> None:
        """Make the operator of a medium; `params` count no ordinates."""
        self._system.dispatch(
            commands,
            (self.cells,),
            params=params,
            density=density,
            links=self._links,
            **self._mix.cell_bound,
        )

    def encode(self, commands: Commands, params: MediumParams, density: Buffer, steps: int) -> None:
        """Solve for `deposits` by `steps` steps."""
        v, cells = self._vectors, (self.cells,)
        common = {"params": params, "links": self._links, "sums": self._sums, "z": v["z"]}
        self._begin.dispatch(
            commands,
            cells,
            **common,
            density=density,
            deposits=self.deposits,
            residual=v["residual"],
            phi=v["phi"],
            **self._mix.cell_bound,
        )
        for step in range(steps):
            before, search = v[f"search {step % 2}"], v[f"search {1 - step % 2}"]
            iteration = StepParams(step=step)
            self._search.dispatch(
                commands,
                cells,
                **common,
                iteration=iteration,
                before=before,
                search=search,
                product=v["product"],
            )
            self._update.dispatch(
                commands,
                cells,
                **common,
                iteration=iteration,
                search=search,
                product=v["product"],
                phi=v["phi"],
                residual=v["residual"],
            )
        self._flux.dispatch(
            commands,
            cells,
            params=params,
            density=density,
            deposits=self.deposits,
            phi=v["phi"],
            diffuse=self.diffuse,
            **self._mix.cell_bound,
        )

    @property
    def residual(self) -> Buffer:
        """b - A phi, W m^-3, vec4 per cell: how far the last solve got."""
        return self._vectors["residual"]
