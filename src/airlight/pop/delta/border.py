"""Diffuse light enters a finer grid through its border, from the solution of the next larger one.

A finer grid's outer faces are open, as those of a medium's own grid are, and what comes in there is
the partial current of the larger grid's solution; see `maths.nested_diffusion`.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32, vec3f, vec3u
from ...gpu.memory import Buffer
from ...gpu.slots import Slot, storage, uniform
from ..medium.finer_medium import FinerMedium
from ..medium.mixture import Mixture
from ..medium.placement import MediumParams
from .diffuse import Diffuse


class OuterParams(Struct):
    """The cells of the next larger grid."""

    offset = vec3f("m, from its corner to that of the finer grid")
    cells = u32()
    cell = vec3f("m")
    count = vec3u("cells")


class _Entering(ComputePass):
    workgroup = (64, 1, 1)

    target: Slot

    def __init__(self, gpu: Gpu, mixture: Mixture) -> None:
        self.slots = (
            uniform("params", MediumParams),
            uniform("outer", OuterParams),
            storage("density", "f32"),
            storage("outer_phi", "vec4f"),
            storage("outer_diffuse", "vec4f"),
            self.target,
            *mixture.cell_slots,
        )
        super().__init__(gpu, generated=mixture.cell_wgsl)


class _Power(_Entering):
    target = storage("deposits", "vec4f", "read_write")
    file = "border.wgsl"


class _Flux(_Entering):
    target = storage("diffuse", "vec4f", "read_write")
    file = "border_flux.wgsl"


class Border:
    """What enters a finer grid from the solution of the next larger one."""

    def __init__(self, medium: FinerMedium, mixture: Mixture, outer: Diffuse) -> None:
        gpu = medium.gpu
        self._medium, self._mixture, self._outer = medium, mixture, outer
        self._power, self._flux = _Power(gpu, mixture), _Flux(gpu, mixture)

    def encode_power(self, commands: Commands, params: MediumParams, deposits: Buffer) -> None:
        """Add the power that enters to `deposits`, before the solve."""
        self._dispatch(commands, params, self._power, deposits=deposits)

    def encode_flux(self, commands: Commands, params: MediumParams, diffuse: Buffer) -> None:
        """Add what enters to the net flux of `diffuse`, after the solve."""
        self._dispatch(commands, params, self._flux, diffuse=diffuse)

    def _dispatch(
        self, commands: Commands, params: MediumParams, which: _Entering, **target: Buffer
    ) -> None:
        # Faces of the finer grid are looked up in the cells of the larger one.
        medium, at = self._medium, self._medium.of.placement
        which.dispatch(
            commands,
            (medium.cells,),
            params=params,
            outer=OuterParams(offset=medium.offset, cells=at.cells, cell=at.cell, count=at.count),
            density=medium.density.cells,
            outer_phi=self._outer.phi,
            outer_diffuse=self._outer.diffuse,
            **target,
            **self._mixture.cell_bound,
        )
