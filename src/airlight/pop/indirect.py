"""Indirect light of surfaces in a medium, from a solved lattice around it.

The lattice knows no medium. Under a uniform sky of radiance 1 the medium's own solution is the
share of light that reaches each cell, absorption included; times the radiance of the lattice there,
that is what arrives. It is exact where the radiance of the lattice is uniform, or where a thin
medium absorbs nothing. differs: Elek2014 section 6 lights the medium by virtual point lights, of
which one needs hundreds.
"""

from __future__ import annotations

from ..fields import ReflectedLight
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f
from ..gpu.memory import Buffer, linear_sampler
from ..gpu.slots import sampler, storage, uniform
from ..lattice.blockers import BLOCKER_SLOTS
from ..lattice.lookup import CHANNEL_SLOTS
from ..lattice.placement import LatticeParams
from ..lattice.table import LatticeTable
from ..maths.ordinates import uniform_sky
from ..maths.transforms import F64
from .delta.beams import DeltaBeams
from .light.incident import IncidentLight
from .medium.grid_medium import GridMedium
from .medium.placement import MediumParams
from .settings import PopSettings

_WHITE = 0.999  # an albedo above it counts as absorbing nothing


class IndirectParams(Struct):
    """The eye, and how the lattice is read."""

    eye = vec3f("m, in the frame of the medium")
    scale = f32("radiance per stored unit, in units of the emission's scale")
    direct = f32("share of the states' direction that the phase function keeps, per g")
    is_whole = u32("1: all of the lattice's light arrives in the medium")


class _Indirect(ComputePass):
    own_slots = (
        uniform("params", MediumParams),
        uniform("reflected", IndirectParams),
        storage("diffuse", "vec4f"),
        storage("reach", "u32"),
        storage("lattices", LatticeParams),
        sampler("linear_clamp"),
        *CHANNEL_SLOTS,
        *BLOCKER_SLOTS,
        storage("indirect", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "indirect.wgsl"

    def __init__(self, gpu: Gpu, light: IncidentLight) -> None:
        self.slots = (*self.own_slots, *light.slots)
        super().__init__(gpu, generated=light.mixture.beam_wgsl(has_blocks=False))


class IndirectLight:
    """Fills `Emission.indirect`: scattered radiance per unit scattering coefficient."""

    def __init__(
        self, medium: GridMedium, settings: PopSettings, outer: IndirectLight | None = None
    ) -> None:
        """`outer`: of a finer grid, that of the next larger one."""
        # The light of the lattice is not solved for itself: a cell receives the share of it that a
        # uniform sky of radiance 1 sends there.
        self._medium = medium
        self._sky = uniform_sky(settings.ordinates)
        around: DeltaBeams | None = outer._uniform if outer else None
        self._uniform: DeltaBeams = DeltaBeams(
            medium, settings, settings.ordinates, medium.mixture, outer=around
        )
        self._pass = _Indirect(medium.gpu, self._uniform.light)
        self._linear = linear_sampler(medium.gpu)
        self._lattices: LatticeTable | None = None

    def encode_medium(
        self, commands: Commands, params: MediumParams, reflected: ReflectedLight
    ) -> None:
        """Take a changed medium: solve it under a uniform sky, whose ordinates `params` count."""
        # The share of light that reaches each cell is the fluence under a uniform sky of radiance
        # 1. Where all of it arrives nobody reads the solution.
        self._uniform.write(self._sky, (), 1.0)
        self._uniform.encode_medium(commands, params)
        if not self._is_whole(reflected):
            self._uniform.encode(commands, params)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        eye: F64,
        reflected: ReflectedLight,
        scale: float,
        target: Buffer,
    ) -> None:
        """Fill `target` for an eye at `eye` (3,), m in the frame of the medium.

        `scale`: radiance per unit of `target`.
        """
        # Each cell looks the lattices up, and scatters what arrives of their light towards the eye.
        medium, source = self._medium, reflected.source
        light = self._uniform.light
        self._pass.dispatch(
            commands,
            (medium.cells,),
            params=params,
            reflected=IndirectParams(
                eye=eye,
                scale=source.scale / scale,
                direct=source.direct,
                is_whole=int(self._is_whole(reflected)),
            ),
            **light.bound,
            diffuse=self._uniform.diffuse.diffuse,
            reach=medium.density.reach,
            lattices=self._table(len(source.levels)).filled([p.params() for p in source.levels]),
            linear_clamp=self._linear,
            **source.bound,
            indirect=target,
        )

    def _table(self, count: int) -> LatticeTable:
        if self._lattices is None:
            self._lattices = LatticeTable(self._medium.gpu, count)
        return self._lattices

    @property
    def count(self) -> int:
        """Ordinates of the uniform sky."""
        return self._sky.count

    def _is_whole(self, reflected: ReflectedLight) -> bool:
        """Whether all light arrives: nothing is absorbed, or the lattice knows the medium."""
        return min(self._medium.albedo) > _WHITE or reflected.knows_media
