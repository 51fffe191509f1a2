"""Light that media scatter forwards alone: from lights as beams, which no ray of a gather meets."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec2u
from ..gpu.memory import Texture, linear_sampler
from ..gpu.slots import sampler, storage, texture, uniform
from ..lattice.blockers import SURFACE_BLOCKER_SLOTS
from ..lattice.irradiance import Irradiance
from ..lattice.lookup import CHANNEL_SLOTS
from ..lattice.placement import LatticeParams
from ..lighting.kit import Kit
from .points import Points
from .sums import read_sums, written_sums


class BeamParams(Struct):
    """Points, and how many rays their sums are of."""

    reduced = vec2u("points")
    rays = u32("of a point")
    pad = u32()


class _Beams(ComputePass):
    slots = (
        uniform("params", BeamParams),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        storage("lattices", LatticeParams),
        *CHANNEL_SLOTS,
        *SURFACE_BLOCKER_SLOTS,
        sampler("linear_clamp"),
        read_sums("sums"),
        written_sums(),
    )
    workgroup = (8, 8, 1)
    file = "beams.wgsl"


class Beams:
    """Reads it from lattices, into the sums of gather points."""

    def __init__(self, gpu: Gpu, kit: Kit) -> None:
        self._kit, self._pass, self._linear = kit, _Beams(gpu), linear_sampler(gpu)

    def encode(
        self,
        commands: Commands,
        points: Points,
        sums: tuple[Texture, Texture],
        rays: int,
        irradiance: Irradiance,
    ) -> Texture:
        """The first of two images of `sums` with it, in the second; sums are of so many `rays`."""
        given, made = sums
        # Read from lattices at each point, as the sum that its rays would have found.
        self._pass.dispatch(
            commands,
            points.reduced,
            params=BeamParams(reduced=points.reduced, rays=rays, pad=0),
            places=points.places,
            normals=points.normals,
            **irradiance.bound,
            **self._kit.blockers.surface_bound,
            linear_clamp=self._linear,
            sums=given,
            sums_after=made,
        )
        return made
