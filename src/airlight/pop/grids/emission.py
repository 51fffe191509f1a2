"""What cells scatter towards the eye where light hops: beams, lobes and the residuum.

Also the paper's own residuum, radiance that hops isotropically (Elek2014 section 5.4).
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, u32
from ...gpu.memory import Buffer, Texture
from ...gpu.slots import image, sampler, storage, texture, uniform
from ...maths.transforms import F64
from ..delta.emission import ViewParams, seen_by
from ..light.ordinates import OrdinateData, OrdinateTable
from ..medium.placement import MediumParams, MediumPlacement
from .grids import HopParams


class IsotropicParams(Struct):
    """Which hop of the paper's residuum this is."""

    step = u32()
    scale = f32("m^-2: radiance per unit of what is read")


class HopEmission(ComputePass):
    """Fills the texture of `Emission`."""

    slots = (
        uniform("params", MediumParams),
        uniform("hops", HopParams),
        storage("ordinates", OrdinateData),
        storage("phase", "vec4f"),
        storage("passed", "f32"),
        storage("diffuse", "vec4f"),
        storage("reach", "u32"),
        storage("merged", "vec4f"),
        uniform("view", ViewParams),
        texture("sky_gain"),
        sampler("sky_sampler"),
        image("emission", "rgba16float", "3d"),
    )
    workgroup = (64, 1, 1)

    def __init__(self, gpu: Gpu) -> None:
        super().__init__(gpu, generated="//! use one_medium_beams\n")

    def encode(self, commands: Commands, cells: int, **bound: Any) -> None:
        """Cell by cell; `bound` names every slot."""
        self.dispatch(commands, (cells,), **bound)


class _Isotropic(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("isotropic", IsotropicParams),
        storage("density", "f32"),
        storage("light_in", "vec4f"),
        storage("light_out", "vec4f", "read_write"),
        storage("diffuse", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "residuum.wgsl"


class Isotropic:
    """The paper's residuum on the medium's cells."""

    def __init__(self, gpu: Gpu, placement: MediumPlacement) -> None:
        self.cells = placement.cells
        self._states = [Buffer(gpu, f"isotropic light {k}", 16 * self.cells) for k in (0, 1)]
        self._hop = _Isotropic(gpu)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        placement: MediumPlacement,
        density: Buffer,
        deposits: Buffer,
        diffuse: Buffer,
        iterations: int,
    ) -> None:
        """Sum `iterations` hops of `deposits` (W per cell) into `diffuse`; 0: leave it dark."""
        cell = placement.cell
        section = float(cell.prod() / cell.mean())
        for step in range(max(1, iterations)):
            scale = 1.0 / section if step == 0 else 1.0
            self._hop.dispatch(
                commands,
                (self.cells,),
                params=params,
                isotropic=IsotropicParams(step=step, scale=scale if iterations else 0.0),
                density=density,
                light_in=self._states[step % 2] if step else deposits,
                light_out=self._states[1 - step % 2],
                diffuse=diffuse,
            )


def bound_emission(
    params: MediumParams,
    hops: HopParams,
    table: OrdinateTable,
    eye: F64,
    passed: Buffer,
    diffuse: Buffer,
    reach: Buffer,
    merged: Buffer,
    emission: Texture,
) -> dict[str, Any]:
    """The slots of `HopEmission` by name; `eye` (3,), m in the medium's frame."""
    return {
        "params": params,
        "hops": hops,
        **seen_by(table, eye, 0.0),
        "passed": passed,
        "diffuse": diffuse,
        "reach": reach,
        "merged": merged,
        "emission": emission,
    }
