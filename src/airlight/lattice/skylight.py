"""The environment's direct light on surfaces, with shadows: an ambient cube per cell.

For each cell and each sky light, depth maps say how much of the light arrives; the irradiance on
the six axis directions is stored (McTaggart2004) and blended by the squared normal. It is of low
frequency by construction, but occluded: a room without windows stays dark.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, i32, pack_array, u32, vec4f
from ..gpu.memory import Buffer, Sampler, Texture
from ..gpu.rows import table
from ..gpu.slots import FILTERED, image, sampler, storage, texture, uniform
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps
from ..surface.sky import SkyLight
from .blockers import BLOCKER_SLOTS
from .placement import LatticeParams, Placement

FACES = 6  # +x -x +y -y +z -z, stacked along the texture's z


class SkylightParams(Struct):
    """The number of sky lights, and how far the lattice moved since its cubes were made."""

    lights = u32()
    has_previous = u32("1: the lattice moved, its light did not change")
    shift_x = i32("cells that the lattice moved")
    shift_y = i32("cells")
    shift_z = i32("cells")


class SkyLightData(Struct):
    """One sky light."""

    direction = vec4f("of travel; w: tangent of the radius of the disc that it comes from")
    irradiance = vec4f("W m^-2; w unused")


class _Skylight(ComputePass):
    slots = (
        uniform("params", SkylightParams),
        uniform("lattice", LatticeParams),
        storage("sky", SkyLightData),
        table("views", LightViewData),
        texture("depth", "2d-array", "depth"),
        sampler("compare", "comparison"),
        *BLOCKER_SLOTS,
        texture("previous", "3d"),
        image("cube", FILTERED, "3d"),
    )
    workgroup = (8, 8, 4)
    in_bands = True
    file = "skylight.wgsl"


class Skylight:
    """The ambient cubes of one lattice, recomputed only where light or geometry changed."""

    def __init__(
        self,
        gpu: Gpu,
        placement: Placement,
        capacity: int,
        *,
        size: tuple[int, int, int] | None = None,
        owner: Skylight | None = None,
    ) -> None:
        """For up to `capacity` lights. `size`: in cells, of a texture that nested lattices share
        (the lattice's own if not given); `owner`: the one of them that owns the texture.
        """
        self.placement, self._is_owner = placement, owner is None

        # The largest lattice owns the texture; the others write their rows of it.
        nx, ny, nz = size or placement.count
        self.cube: Texture = (
            owner.cube
            if owner
            else Texture(
                gpu, "sky light", (nx, ny, FACES * nz), FILTERED, dimension="3d", written=True
            )
        )
        # The cubes of a lattice that moves, as they were before it did.
        columns, rows, _ = placement.count
        size_before = (1, 1, 1) if owner is None else (columns, rows, FACES * self._depth)
        self._previous = Texture(gpu, "sky light before", size_before, FILTERED, dimension="3d")
        self._made: Placement | None = None
        self._lights = Buffer(gpu, "sky lights", SkyLightData.dtype.itemsize * max(1, capacity))
        self._pass = _Skylight(gpu)

    def encode(
        self,
        commands: Commands,
        lights: Sequence[SkyLight],
        maps: ReflectiveShadowMaps,
        compare: Sampler,
        blockers: Mapping[str, Texture],
        *,
        is_same_light: bool = False,
    ) -> None:
        """Fill the cubes from the depth maps of `lights`.

        `is_same_light`: neither lights nor geometry changed since the last time, only the lattice's
        placement; then only the cells that are new to it are computed.
        """
        # Where only the lattice moved, cells that it had before keep what they have.
        shift = self._shift() if is_same_light and not self._is_owner else None
        if shift is not None:
            self._copy_previous(commands)
        self._made = self.placement
        # All lights into all cells.
        rows = [
            {"direction": (*light.direction, light.spread), "irradiance": (*light.irradiance, 0.0)}
            for light in lights
        ]
        self._lights.write(pack_array(SkyLightData, rows))
        self._pass.dispatch(
            commands,
            self.placement.count,
            params=_params(len(lights), shift),
            lattice=self.placement.params(),
            sky=self._lights,
            views=maps.views,
            depth=maps.depth,
            compare=compare,
            **blockers,
            previous=self._previous,
            cube=self.cube,
        )

    @property
    def _depth(self) -> int:
        return self.cube.size[2] // FACES

    def _shift(self) -> tuple[int, int, int] | None:
        """The cells that the lattice moved since its cubes were made; None where they are of no
        use.
        """
        # Cells of another size, or off the grid, have no counterpart.
        if self._made is None or self._made.cell != self.placement.cell:
            return None
        moved = np.subtract(self.placement.origin, self._made.origin) / self.placement.cell
        x, y, z = (int(v) for v in np.round(moved))
        return (x, y, z) if np.abs(moved - (x, y, z)).max() < 1e-3 else None

    def _copy_previous(self, commands: Commands) -> None:
        # A pass cannot read the texture that it writes, so the lattice's rows are copied first.
        columns, rows, _ = self.placement.count
        commands.encoder.copy_texture_to_texture(
            {"texture": self.cube.handle, "origin": (0, self.placement.first_row, 0)},
            {"texture": self._previous.handle},
            (columns, rows, FACES * self._depth),
        )


def _params(lights: int, shift: tuple[int, int, int] | None) -> SkylightParams:
    x, y, z = shift or (0, 0, 0)
    return SkylightParams(
        lights=lights, has_previous=int(shift is not None), shift_x=x, shift_y=y, shift_z=z
    )
