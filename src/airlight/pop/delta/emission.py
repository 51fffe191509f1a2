"""The radiance that every cell scatters towards the eye: beams, quasi-forward and diffuse light."""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ...gpu.memory import Buffer, BufferPart, Texture
from ...gpu.slots import Slot, image, sampler, storage, texture, uniform
from ...maths.transforms import F64
from ..light.incident import IncidentLight
from ..light.table import OrdinateData, OrdinateTable
from ..medium.grid_medium import GridMedium
from ..medium.mixture import Mixture
from ..medium.placement import MediumParams
from ..settings import PopSettings
from .diffuse import Diffuse
from .outgoing import Outgoing
from .smooth import SmoothEmission


class ViewParams(Struct):
    """The eye in the frame of the medium."""

    eye = vec3f("m")
    correction = f32("exponent of the furnace correction; 0 for none")
    sky_from_medium = mat4x4f("directions of the medium in the sky's map")
    has_local_shafts = u32("1: what local lights scatter once is drawn by shafts")


class _OfBeams(ComputePass):
    own_slots: tuple[Slot, ...]

    def __init__(self, gpu: Gpu, mixture: Mixture, *, has_blocks: bool) -> None:
        self.slots = (*self.own_slots, *mixture.beam_slots)
        super().__init__(gpu, generated=mixture.beam_wgsl(has_blocks=has_blocks))


# What the frame's emission and the furnace's corrections both read.
_read: tuple[Slot, ...] = (
    uniform("params", MediumParams),
    uniform("view", ViewParams),
    storage("ordinates", OrdinateData),
    storage("phase", "vec4f"),
    storage("passed", "f32"),
    storage("diffuse", "vec4f"),
    storage("reach", "u32"),
    texture("sky_correction"),
    sampler("sky_sampler"),
)


EMISSION_SLOTS: tuple[Slot, ...] = (
    image("emission", "rgba16float", "3d"),
    image("whole", "rgba16float", "3d"),
)
"""As `wgsl/store_emission.wgsl` writes them."""


class _Emission(_OfBeams):
    own_slots = (
        *_read,
        storage("refined", "vec4f"),
        *EMISSION_SLOTS,
        image("mean", "rgba16float", "3d"),
    )
    workgroup = (64, 1, 1)
    file = "emission.wgsl"


class _Furnace(_OfBeams):
    own_slots = (*_read, storage("corrections", "vec4f", "read_write"))
    workgroup = (64, 1, 1)
    file = "emission_furnace.wgsl"


class Emission:
    """Fills `texture`: in-scattered radiance per unit scattering coefficient.

    `whole` is that with what local lights scatter once, which `texture` leaves to shafts if they
    draw it; `smooth` is the `texture` between its cells, for marching. `mean` is what the reduced
    medium of similarity theory scatters, into all directions alike, still per unit of the medium's
    own scattering coefficient; of channels with g <= 0 it is `whole`. The unit is the scale of the
    ordinates: times `OrdinateTable.scale`, W m^-2 sr^-1.
    `corrections`, vec4 per cell: factors of multiple scattering, see `encode_furnace`. `indirect`,
    vec4 per cell: indirect light of surfaces, in the same unit.
    """

    def __init__(
        self, medium: GridMedium, settings: PopSettings, *, has_local_shafts: bool = False
    ) -> None:
        """`has_local_shafts`: what local lights scatter once is drawn by shafts, left out here."""
        gpu, mixture = medium.gpu, medium.mixture
        self.has_local_shafts = has_local_shafts
        self.medium, self._correction = medium, settings.furnace_correction
        # The radiance of cells, and the same on cells half as wide, which is marched.
        self.texture = Texture(
            gpu, "emission", medium.placement.count, "rgba16float", dimension="3d", written=True
        )
        self.smooth = SmoothEmission(medium)
        # Light that hops fills no mean, and nobody asks for it (`Transport.has_mean`).
        count = medium.placement.count if settings.scheme == "delta-beam" else (1, 1, 1)
        self.mean = Texture(
            gpu, "mean emission", count, "rgba16float", dimension="3d", written=True
        )
        # Nothing is written to a second texture that would be the same.
        count = medium.placement.count if has_local_shafts else (1, 1, 1)
        self._other = Texture(
            gpu, "whole emission", count, "rgba16float", dimension="3d", written=True
        )
        # Both parts lie in one buffer: some devices bind no more than eight per stage. Indirect
        # light is 0 until another pass fills it.
        nbytes = -(-16 * medium.cells // BufferPart.ALIGNMENT) * BufferPart.ALIGNMENT
        self._refined = Buffer(gpu, "furnace corrections and indirect light", 2 * nbytes)
        self.corrections = BufferPart(self._refined, 0, 16 * medium.cells)
        self.indirect = BufferPart(self._refined, nbytes, 16 * medium.cells)
        # Diffuse light towards the eye is computed first, for the frame and for the furnace alike.
        self._outgoing = Outgoing(medium)
        self._emission = _Emission(gpu, mixture, has_blocks=True)
        self._furnace = _Furnace(gpu, mixture, has_blocks=False)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        eye: F64,
        light: IncidentLight,
        diffuse: Diffuse,
    ) -> None:
        """Fill `texture` for an eye at `eye` (3,), m in the frame of the medium."""
        # Diffuse light towards the eye comes first, because the emission adds it to the ordinates'.
        self._outgoing.encode(commands, params, eye, diffuse, light.mixture)
        self._emission.dispatch(
            commands,
            (self.medium.cells,),
            params=params,
            **bound_by_view(
                light.table, eye, self._correction, has_local_shafts=self.has_local_shafts
            ),
            **self._bound(light, diffuse),
            refined=self._refined,
            mean=self.mean,
            **self.written,
        )

    @property
    def whole(self) -> Texture:
        """All that is scattered towards the eye, by light of any order."""
        return self._other if self.has_local_shafts else self.texture

    @property
    def written(self) -> dict[str, Texture]:
        """By slot name, of `EMISSION_SLOTS`."""
        return {"emission": self.texture, "whole": self._other}

    def encode_furnace(
        self,
        commands: Commands,
        params: MediumParams,
        eye: F64,
        light: IncidentLight,
        diffuse: Diffuse,
    ) -> None:
        """Fill `corrections` from the medium without absorption under a uniform sky of radiance 1.

        `light` and `diffuse` are those of that medium.
        """
        # The steps of the frame's emission; what differs from radiance 1 is corrected.
        self._outgoing.encode(commands, params, eye, diffuse, light.mixture)
        self._furnace.dispatch(
            commands,
            (self.medium.cells,),
            params=params,
            **bound_by_view(light.table, eye, 0.0),
            **self._bound(light, diffuse),
            corrections=self.corrections,
        )

    def _bound(self, light: IncidentLight, diffuse: Diffuse) -> dict[str, Any]:
        """What both passes read of the cells, by slot name."""
        return {
            "passed": light.passed,
            **light.mixture.beam_bound,
            "diffuse": diffuse.diffuse,
            "reach": self.medium.density.reach,
        }


def bound_by_view(
    table: OrdinateTable, eye: F64, correction: float, *, has_local_shafts: bool = False
) -> dict[str, Any]:
    """The ordinates and the eye, by slot name."""
    # The correction is a map in the sky's frame, which rotates with the environment.
    sky = table.correction
    view = ViewParams(
        eye=eye,
        correction=correction,
        sky_from_medium=sky.sky_from_medium,
        has_local_shafts=int(has_local_shafts),
    )
    return {
        "view": view,
        "ordinates": table.rows,
        "phase": table.phase,
        "sky_correction": sky.texture,
        "sky_sampler": sky.sampler,
    }
