"""What goes from every cell towards the eye as diffuse light; see `maths.outgoing_light`."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, vec3f
from ...gpu.slots import storage, uniform
from ...maths.transforms import F64
from ..medium.grid_medium import GridMedium
from ..medium.mixture import Mixture
from ..medium.placement import MediumParams
from .diffuse import Diffuse


class EyeParams(Struct):
    """The eye in the frame of the medium."""

    position = vec3f("m")


class Outgoing(ComputePass):
    """Fills the last sections of `Diffuse.diffuse`, of which emission is made.

    vec4 [S, k, own][z][y][x]: radiance per unit of the extinction k, m^-1, and what the medium
    scatters smoothly per unit of its scattering; rgb. Behind k: which faces surfaces close.
    """

    workgroup = (64, 1, 1)

    def __init__(self, medium: GridMedium) -> None:
        mixture, self._medium = medium.mixture, medium
        self.slots = (
            uniform("params", MediumParams),
            uniform("eye", EyeParams),
            storage("density", "f32"),
            storage("deposits", "vec4f"),
            storage("walls", "u32"),
            storage("diffuse", "vec4f", "read_write"),
            *mixture.cell_slots,
        )
        super().__init__(medium.gpu, generated=mixture.cell_wgsl)

    def encode(
        self, commands: Commands, params: MediumParams, eye: F64, light: Diffuse, mixture: Mixture
    ) -> None:
        """Of diffuse `light` in a `mixture`, for an eye at (3,), m in the frame of the medium."""
        self.dispatch(
            commands,
            (self._medium.cells,),
            params=params,
            eye=EyeParams(position=eye),
            density=self._medium.density.cells,
            deposits=light.deposits,
            walls=light.walls,
            diffuse=light.diffuse,
            **mixture.cell_bound,
        )
