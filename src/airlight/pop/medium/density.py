"""The density of a medium in its cells: means of a volume's voxels, trilinear between them.

Samples are spread evenly in a fine cell, one to 16 per axis and at least one per voxel in that
range; the density is 0 outside the volume. A cell is the mean of its eight fine cells.
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
from .mixture import Mixture, fine_bound, fine_slots, fine_wgsl
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


class _Cells(ComputePass):
    slots = (
        uniform("params", MediumParams),
        texture("fine", "3d"),
        storage("density", "f32", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "density_cells.wgsl"


class _Others(ComputePass):
    workgroup = (64, 1, 1)
    file = "density_others.wgsl"

    def __init__(self, gpu: Gpu, mixture: Mixture) -> None:
        self.slots = (
            uniform("params", MediumParams),
            *mixture.cell_slots,
            *fine_slots(mixture.media - 1),
            sampler("linear_clamp"),
            storage("density", "f32", "read_write"),
        )
        super().__init__(gpu, generated=fine_wgsl(mixture.media - 1))


class _Reach(ComputePass):
    slots = (
        uniform("params", MediumParams),
        storage("density", "f32"),
        storage("reach", "u32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "density_reach.wgsl"

    def __init__(self, gpu: Gpu, mixture: Mixture) -> None:
        super().__init__(gpu, generated=f"const MEDIA = {mixture.media}u;\n")


class Density:
    """The density of all media on the grid of one.

    `fine`: a filterable 3D texture of the medium's own density, in x; `fine_parts`: those of its
    further parts. `cells`: f32 [medium][z][y][x], means of its own density first, then of those
    parts, then of the other media. `reach`: u32, 1
    where a cell or one beside it holds any medium; other cells need no light.
    """

    def __init__(self, gpu: Gpu, placement: MediumPlacement, mixture: Mixture) -> None:
        self.placement, self._mixture = placement, mixture
        # Fine densities of its own parts, which paths and other media sample; means of all media.
        fines = [_fine_texture(gpu, placement) for _ in range(mixture.count.own)]
        self.fine, self.fine_parts = fines[0], fines[1:]
        self.cells = Buffer(gpu, "density", 4 * placement.cells * mixture.media)
        self.reach = Buffer(gpu, "reach of the medium", 4 * placement.cells)
        self._fine, self._cells, self._reach = _Fine(gpu), _Cells(gpu), _Reach(gpu, mixture)
        self._others = None if mixture.is_alone else _Others(gpu, mixture)
        self.linear = linear_sampler(gpu)

    def encode(self, commands: Commands, params: MediumParams, voxels: Sequence[Texture]) -> None:
        """Fill `fine`, `fine_parts` and the medium's own part of `cells` from each one's voxels."""
        # Paths and other media sample the fine densities; the cells' own means follow from them.
        fine_count, cells = self.placement.fine_count, (self.placement.cells,)
        for own, fine in zip(voxels, (self.fine, *self.fine_parts), strict=True):
            self._fine.dispatch(
                commands,
                fine_count,
                params=params,
                voxels=own,
                linear_clamp=self.linear,
                fine=fine,
            )
        self._cells.dispatch(commands, cells, params=params, fine=self.fine, density=self.cells)

    def encode_others(
        self, commands: Commands, params: MediumParams, others: Sequence[Texture]
    ) -> None:
        """Fill the rest of `cells` from the `fine` densities of the `others`, then `reach`."""
        # Every medium in a cell attenuates its light, so a cell stores the density of each.
        cells = self.placement.cells
        if self._others is not None:
            self._others.dispatch(
                commands,
                (cells, 1 + len(others)),
                params=params,
                **self._mixture.cell_bound,
                **fine_bound(others),
                linear_clamp=self.linear,
                density=self.cells,
            )
        self._reach.dispatch(
            commands, (cells,), params=params, density=self.cells, reach=self.reach
        )


def _fine_texture(gpu: Gpu, placement: MediumPlacement) -> Texture:
    size = placement.fine_count
    return Texture(gpu, "fine density", size, "rgba16float", dimension="3d", written=True)


def density_texture(gpu: Gpu, volume: Volume) -> Texture:
    """The voxels of a volume as a filterable 3D texture."""
    density = shape_density(volume, SPHERE_SIDE)
    depth, height, width = density.shape
    made = Texture(gpu, "density", (width, height, depth), "r16float", dimension="3d")
    made.write(half_floats(density))
    return made


def voxel_count(volume: Volume) -> tuple[int, ...]:
    """The shape of a volume's density grid; () for a shape."""
    return () if volume.density is None else volume.density.shape
