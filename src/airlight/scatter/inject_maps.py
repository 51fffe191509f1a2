"""What every texel of a light's map sends into cells, in fixed point: bit-identical sums.

InjectReflected   light that surfaces reflect, attenuated on its way (Billeter2012 section 3.1)
InjectRays        random points of every texel's ray, scattering (Billeter2012 section 4.1)
"""

from __future__ import annotations

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import Slot, storage, texture, uniform
from ..lattice.inject import LobeParams
from ..lattice.placement import LatticeParams, Placement
from ..maths.lattice26_walls import returned_sharpness
from ..media.gpu_media import GpuMedia
from ..surface.light_table import LightData
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps


class MapParams(Struct):
    """The size of the maps, and how rays are sampled."""

    resolution = u32("texels")
    layers = u32()
    samples = u32("points per ray; 0 for reflected light")
    seed = u32()
    is_stratified = u32("1: a point in each of `samples` equal parts")


class _InjectMaps(ComputePass):
    """Slots and parameters of both passes."""

    workgroup = (16, 16, 1)

    def __init__(self, gpu: Gpu, air: GpuMedia) -> None:
        self._air = air
        self.slots = (*_slots(), *air.slots)  # type: ignore[misc]
        super().__init__(gpu, generated=air.wgsl)

    def _add(
        self,
        commands: Commands,
        maps: ReflectiveShadowMaps,
        lights: Buffer,
        owners: Buffer,
        placement: Placement,
        walls: Texture,
        sums: Buffer,
        scale: float,
        params: MapParams,
        lobe: float,
    ) -> None:
        lobes = LobeParams(
            scale=scale, lobe=lobe, hop_constant=0.0, hop_directional=0.0, is_shaped=0
        )
        self.dispatch(
            commands,
            (maps.resolution, maps.resolution, maps.layers),
            params=params,
            lobes=lobes,
            lattice=placement.params(),
            views=maps.views,
            lights=lights,
            owners=owners,
            depth=maps.depth,
            normal=maps.normal,
            flux=maps.flux,
            lattice_walls=walls,
            sums=sums,
            **self._air.bound,
        )


class InjectReflected(_InjectMaps):
    """Every texel's reflected flux, half a cell before its surface."""

    file = "inject_reflected.wgsl"

    def encode(
        self,
        commands: Commands,
        maps: ReflectiveShadowMaps,
        lights: Buffer,
        owners: Buffer,
        placement: Placement,
        walls: Texture,
        sums: Buffer,
        scale: float,
    ) -> None:
        """Add to `sums` (`scale` units per W sr^-1); `owners`: each layer's row of `lights`."""
        params = MapParams(
            resolution=maps.resolution, layers=maps.layers, samples=0, seed=0, is_stratified=0
        )
        self._add(
            commands,
            maps,
            lights,
            owners,
            placement,
            walls,
            sums,
            scale,
            params,
            returned_sharpness(),
        )


class InjectRays(_InjectMaps):
    """Points of the rays from a light to what its map sees, or out of the lattice."""

    file = "inject_rays.wgsl"

    def encode(
        self,
        commands: Commands,
        maps: ReflectiveShadowMaps,
        lights: Buffer,
        owners: Buffer,
        placement: Placement,
        walls: Texture,
        sums: Buffer,
        scale: float,
        *,
        samples: int = 8,
        seed: int = 0,
        is_stratified: bool = False,
    ) -> None:
        """As InjectReflected.encode; the same `seed` gives the same bits."""
        params = MapParams(
            resolution=maps.resolution,
            layers=maps.layers,
            samples=samples,
            seed=seed,
            is_stratified=int(is_stratified),
        )
        self._add(commands, maps, lights, owners, placement, walls, sums, scale, params, 0.0)


def owner_rows(owners: list[int]) -> np.ndarray:
    """The upload for `owners`: one u32 per layer, never empty."""
    return np.array(owners or [0], np.uint32)


def _slots() -> tuple[Slot, ...]:
    return (
        uniform("params", MapParams),
        uniform("lobes", LobeParams),
        uniform("lattice", LatticeParams),
        storage("views", LightViewData),
        storage("lights", LightData),
        storage("owners", "u32"),
        texture("depth", "2d-array", "depth"),
        texture("normal", "2d-array", "unfilterable-float"),
        texture("flux", "2d-array", "unfilterable-float"),
        texture("lattice_walls", "3d"),
        storage("sums", "atomic<i32>", "read_write"),
    )
