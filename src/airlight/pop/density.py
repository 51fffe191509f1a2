"""A volume's voxels averaged into the cells of its medium's grid, and into half of them.

Samples are spread evenly in a cell, at least one per voxel and axis up to 16: trilinear between
voxels, 0 outside the volume.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer, Texture, linear_sampler
from ..gpu.slots import image, sampler, storage, texture, uniform
from .placement import MediumParams, MediumPlacement


class _Fine(ComputePass):
    slots = (
        uniform("params", MediumParams),
        texture("voxels", "3d"),
        sampler("linear_clamp"),
        image("fine", "rgba16float", "3d"),
    )
    workgroup = (8, 8, 1)
    file = "density_fine.wgsl"


class _Coarse(ComputePass):
    slots = (
        uniform("params", MediumParams),
        texture("fine", "3d"),
        storage("density", "f32", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "density_coarse.wgsl"


class _Reach(ComputePass):
    slots = (
        uniform("params", MediumParams),
        storage("density", "f32"),
        storage("reach", "u32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "density_reach.wgsl"


class Density:
    """`fine`: a filtered 3D texture, density in x. `cells`: means, f32 [z][y][x].

    `reach`, u32: 1 where a cell or one beside it holds any; the light of others is not asked for.
    """

    def __init__(self, gpu: Gpu, placement: MediumPlacement) -> None:
        self.placement = placement
        self.fine = Texture(
            gpu, "fine density", placement.fine_count, "rgba16float", dimension="3d", written=True
        )
        self.cells = Buffer(gpu, "density", 4 * placement.cells)
        self.reach = Buffer(gpu, "reach of the medium", 4 * placement.cells)
        self._fine, self._coarse, self._reach = _Fine(gpu), _Coarse(gpu), _Reach(gpu)
        self.linear = linear_sampler(gpu)

    def encode(self, commands: Commands, params: MediumParams, voxels: Texture) -> None:
        """Fill both from `voxels`."""
        self._fine.dispatch(
            commands, self.placement.fine_count, params=params, voxels=voxels,
            linear_clamp=self.linear, fine=self.fine,
        )  # fmt: skip
        self._coarse.dispatch(
            commands, (self.placement.cells,), params=params, fine=self.fine, density=self.cells
        )
        self._reach.dispatch(
            commands, (self.placement.cells,), params=params, density=self.cells, reach=self.reach
        )

    def release(self) -> None:
        """Give the memory back."""
        self.fine.release()
        self.cells.release()
        self.reach.release()
