"""Random points of every texel's ray, scattering (Billeter2012 section 4.1): bit-identical sums."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.slots import uniform
from ..lattice.inject import MAP_LIGHT_SLOTS, MAP_SLOTS, MapLights, map_bound
from ..lattice.lobes import TARGET_SLOTS, InjectionTarget, Lobe
from ..media.gpu_media import GpuMedia
from ..surface.reflective import ReflectiveShadowMaps

_ISOTROPIC = Lobe(0.0)


class RayPointParams(Struct):
    """The size of the maps, and how rays are sampled."""

    resolution = u32("texels")
    layers = u32()
    samples = u32("points per ray")
    seed = u32()
    is_stratified = u32("1: a point in each of `samples` equal parts")


@dataclass(frozen=True)
class Sampling:
    """How rays are sampled: `samples` points of each, one in each equal part if `is_stratified`.

    The same `seed` gives the same bits.
    """

    samples: int = 8
    seed: int = 0
    is_stratified: bool = False


class InjectRays(ComputePass):
    """Points of the rays from a light to what its map sees, or out of the lattice."""

    workgroup = (16, 16, 1)

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self._media = media
        self.slots = (
            uniform("params", RayPointParams),
            *MAP_SLOTS,
            *MAP_LIGHT_SLOTS,
            *TARGET_SLOTS,
            *media.slots,
        )
        super().__init__(gpu, generated=media.wgsl)

    def encode(
        self,
        commands: Commands,
        maps: ReflectiveShadowMaps,
        target: InjectionTarget,
        *,
        lights: MapLights,
        sampling: Sampling,
    ) -> None:
        """Add what the media scatter of the light along the rays of all texels of `maps`."""
        self.dispatch(
            commands,
            (maps.resolution, maps.resolution, maps.layers),
            params=RayPointParams.of(
                resolution=maps.resolution,
                layers=maps.layers,
                samples=sampling.samples,
                seed=sampling.seed,
                is_stratified=int(sampling.is_stratified),
            ),
            **map_bound(maps),
            **lights.bound,
            **target.bound(_ISOTROPIC),
            **self._media.bound,
        )


def owner_rows(owners: list[int]) -> np.ndarray:
    """The upload for `owners`: one u32 per layer, never empty."""
    return np.array(owners or [0], np.uint32)
