"""A volume's voxels averaged into the cells of its medium's grid, and into half of them.

Samples are spread evenly in a cell, at least one per voxel and axis up to 16: trilinear between
voxels, 0 outside the volume.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.memory import Buffer, Texture, linear_sampler
from ...gpu.slots import image, sampler, storage, texture, uniform
from ...maths.half import half_floats
from ...scene.volume import Volume
from .mixture import Mix, fine_bound, fine_slots, fine_wgsl
from .placement import SPHERE_SIDE, MediumParams, MediumPlacement, shape_density


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

    def __init__(self, gpu: Gpu, mix: Mix) -> None:
        super().__init__(gpu, generated=f"const MEDIA = {mix.media}u;\n")


class _Others(ComputePass):
    workgroup = (64, 1, 1)
    file = "density_others.wgsl"

    def __init__(self, gpu: Gpu, mix: Mix) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", MediumParams),
            *mix.cell_slots,
            *fine_slots(mix.media - 1),
            sampler("linear_clamp"),
            storage("density", "f32", "read_write"),
        )
        super().__init__(gpu, generated=fine_wgsl(mix.media - 1))


class Density:
    """`fine`: a filtered 3D texture, density in x. `cells`: means, f32 [medium][z][y][x], its own
    first, then what other media there are.

    `reach`, u32: 1 where a cell or one beside it holds any; the light of others is not asked for.
    """

    def __init__(self, gpu: Gpu, placement: MediumPlacement, mix: Mix) -> None:
        self.placement, self._mix = placement, mix
        self.fine = Texture(
            gpu, "fine density", placement.fine_count, "rgba16float", dimension="3d", written=True
        )
        self.cells = Buffer(gpu, "density", 4 * placement.cells * mix.media)
        self.reach = Buffer(gpu, "reach of the medium", 4 * placement.cells)
        self._fine, self._coarse, self._reach = _Fine(gpu), _Coarse(gpu), _Reach(gpu, mix)
        self._others = None if mix.is_alone else _Others(gpu, mix)
        self.linear = linear_sampler(gpu)

    def encode(self, commands: Commands, params: MediumParams, voxels: Texture) -> None:
        """Fill `fine` and the first of `cells` from `voxels`."""
        self._fine.dispatch(
            commands,
            self.placement.fine_count,
            params=params,
            voxels=voxels,
            linear_clamp=self.linear,
            fine=self.fine,
        )
        self._coarse.dispatch(
            commands, (self.placement.cells,), params=params, fine=self.fine, density=self.cells
        )

    def encode_reach(
        self, commands: Commands, params: MediumParams, others: Sequence[Texture]
    ) -> None:
        """Then the rest, from the others' `fine`."""
        if self._others is not None:
            self._others.dispatch(
                commands,
                (self.placement.cells, 1 + len(others)),
                params=params,
                **self._mix.cell_bound,
                **fine_bound(others),
                linear_clamp=self.linear,
                density=self.cells,
            )
        self._reach.dispatch(
            commands, (self.placement.cells,), params=params, density=self.cells, reach=self.reach
        )


def density_texture(gpu: Gpu, volume: Volume) -> Texture:
    """A volume's voxels, filterable."""
    density = shape_density(volume, SPHERE_SIDE)
    depth, height, width = density.shape
    made = Texture(gpu, "density", (width, height, depth), "r16float", dimension="3d")
    made.write(half_floats(density))
    return made


def voxel_count(volume: Volume) -> tuple[int, ...]:
    """Of a density grid; nothing of a shape."""
    return () if volume.density is None else volume.density.shape
