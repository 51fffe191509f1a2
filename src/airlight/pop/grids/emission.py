"""The radiance that cells scatter towards the eye where light propagates in grids.

It is that of beams (light scattered once), of lobes in the grids, and of the residuum.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Buffer
from ...gpu.slots import sampler, storage, texture, uniform
from ...maths.transforms import F64
from ..delta.emission import EMISSION_SLOTS, Emission, ViewParams, bound_by_view
from ..light.incident import IncidentLight
from ..light.table import OrdinateData
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams
from .grids import GridParams
from .propagation import GridPropagation


class GridEmission(ComputePass):
    """Fills the textures of `delta.emission.Emission`."""

    slots = (
        uniform("params", MediumParams),
        uniform("hops", GridParams),
        storage("ordinates", OrdinateData),
        storage("phase", "vec4f"),
        storage("passed", "f32"),
        storage("diffuse", "vec4f"),
        storage("reach", "u32"),
        storage("merged", "vec4f"),
        uniform("view", ViewParams),
        texture("sky_correction"),
        sampler("sky_sampler"),
        *EMISSION_SLOTS,
    )
    workgroup = (64, 1, 1)
    file = "emission.wgsl"

    def __init__(self, medium: GridMedium, propagation: GridPropagation) -> None:
        super().__init__(medium.gpu, generated="//! use one_medium_beams\n")
        self._medium, self._propagation = medium, propagation

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        eye: F64,
        light: IncidentLight,
        diffuse: Buffer,
        emission: Emission,
    ) -> None:
        """Fill `emission` for an eye at `eye` (3,), m in the frame of the medium."""
        # The residuum is in `diffuse`, lobes in the merged light, beams in `passed`.
        propagation = self._propagation
        self.dispatch(
            commands,
            (self._medium.cells,),
            params=params,
            hops=propagation.grids.params(eye),
            **bound_by_view(light.table, eye, 0.0, has_local_shafts=emission.has_local_shafts),
            passed=light.passed,
            diffuse=diffuse,
            reach=self._medium.density.reach,
            merged=propagation.merge.merged,
            **emission.written,
        )
