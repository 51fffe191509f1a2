"""Light that surfaces reflect into a medium, taken from a solved lattice around it.

The lattice knows no medium. Under an even light of radiance 1 the medium's own solution says how
much of it reaches each cell, absorption and all; times the lattice's radiance there, that is what
arrives. Exact where the lattice is even, or nothing is absorbed in thin air. Elek2014 section 6
lights the medium by virtual point lights, of which one needs hundreds; differs: see above.
"""

from __future__ import annotations

from ..fields import ReflectedLight
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ..gpu.memory import Buffer, linear_sampler
from ..gpu.slots import sampler, storage, texture, uniform
from ..lattice.placement import LatticeParams
from ..maths.ordinates import even_sky
from ..maths.transforms import F64
from .light.ordinates import OrdinateData
from .medium.grid_medium import GridMedium
from .medium.placement import MediumParams
from .schemes import Beams
from .settings import PopSettings

_WHITE = 0.999


class BounceParams(Struct):
    """The eye, and how the lattice is read."""

    world_from_medium = mat4x4f()
    eye = vec3f("m, in the medium's frame")
    scale = f32("radiance per stored unit, in units of the emission's scale")
    direct = f32("share of the states' direction that the phase function keeps, per g")
    is_whole = u32("1: the lattice's light is all there in the medium")


class _Bounce(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("bounce", BounceParams),
        storage("ordinates", OrdinateData),
        storage("passed", "f32"),
        storage("diffuse", "vec4f"),
        storage("reach", "u32"),
        uniform("lattice", LatticeParams),
        sampler("linear_clamp"),
        *(
            texture(f"lattice_{name}", "3d")
            for name in ("red", "green", "blue", "visibility_a", "visibility_b", "walls")
        ),
        storage("bounced", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "indirect.wgsl"


class Bounce:
    """Fills `Emission.bounced`, per unit scattering coefficient."""

    def __init__(self, medium: GridMedium, settings: PopSettings) -> None:
        self._medium = medium
        self._sky = even_sky(settings.ordinates)
        self._even = Beams(medium, settings, settings.ordinates, medium.mix)
        self._pass, self._linear = _Bounce(medium.gpu), linear_sampler(medium.gpu)

    def encode_medium(
        self, commands: Commands, params: MediumParams, bounced: ReflectedLight
    ) -> None:
        """Take a changed medium; `params` count the even sky's ordinates."""
        self._even.write(self._sky, (), 1.0)
        self._even.encode_medium(commands, params)
        if not (self._is_white or bounced.knows_media):
            self._even.encode(commands, params)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        eye: F64,
        bounced: ReflectedLight,
        scale: float,
        target: Buffer,
    ) -> None:
        """For an eye at `eye` (3,), m in the medium's frame; `scale`: radiance per unit of
        `target`.
        """
        placement, source = self._medium.placement, bounced.source
        bounce = BounceParams(
            world_from_medium=placement.world_from_medium,
            eye=eye,
            scale=source.scale / scale,
            direct=source.direct,
            is_whole=int(self._is_white or bounced.knows_media),
        )
        self._pass.dispatch(
            commands,
            (placement.cells,),
            params=params,
            bounce=bounce,
            ordinates=self._even.table.rows,
            passed=self._even.paths.passed,
            diffuse=self._even.diffuse.diffuse,
            reach=self._medium.density.reach,
            lattice=source.placement.params(),
            linear_clamp=self._linear,
            **source.bound,
            bounced=target,
        )

    @property
    def count(self) -> int:
        """Ordinates of the even sky."""
        return self._sky.count

    @property
    def _is_white(self) -> bool:
        return min(self._medium.volume.albedo) > _WHITE
