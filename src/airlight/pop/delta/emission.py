"""What every cell scatters towards the eye: beams, quasi-forward light and diffuse light."""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, vec3f
from ...gpu.memory import Buffer, BufferPart, Texture
from ...gpu.slots import Slot, image, sampler, storage, texture, uniform
from ...maths.transforms import F64
from ..light.ordinates import OrdinateData, OrdinateTable
from ..medium.mixture import Mix
from ..medium.placement import MediumParams, MediumPlacement


class ViewParams(Struct):
    """The eye in the medium's frame."""

    eye = vec3f("m")
    correction = f32("exponent of the furnace correction; 0 for none")
    sky_from_medium = mat4x4f("directions of the medium in the sky's map")


class _OfBeams(ComputePass):
    own_slots: tuple[Slot, ...]

    def __init__(self, gpu: Gpu, mix: Mix, *, has_blocks: bool) -> None:
        self.slots = (*self.own_slots, *mix.beam_slots)  # type: ignore[misc]
        super().__init__(gpu, generated=mix.beam_wgsl(has_blocks=has_blocks))


class _Emission(_OfBeams):
    own_slots = (
        uniform("params", MediumParams),
        uniform("view", ViewParams),
        storage("ordinates", OrdinateData),
        storage("phase", "vec4f"),
        storage("passed", "f32"),
        storage("diffuse", "vec4f"),
        storage("reach", "u32"),
        texture("sky_gain"),
        sampler("sky_sampler"),
        storage("refined", "vec4f"),
        image("emission", "rgba16float", "3d"),
    )
    workgroup = (64, 1, 1)
    file = "emission.wgsl"


class _Furnace(_OfBeams):
    own_slots = (
        *_Emission.own_slots[:9],
        storage("corrections", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "emission_furnace.wgsl"


class Emission:
    """Fills `texture`: in-scattered radiance per unit scattering coefficient.

    In units of the ordinates' scale: times `OrdinateTable.scale`, W m^-2 sr^-1.
    """

    def __init__(self, gpu: Gpu, placement: MediumPlacement, mix: Mix) -> None:
        self._mix, self.cells = mix, placement.cells
        self.texture = Texture(
            gpu, "emission", placement.count, "rgba16float", dimension="3d", written=True
        )
        # Furnace corrections, and what surfaces reflect into the medium: 0 until `Bounce` says
        # otherwise. One buffer, since stages bind eight at least, and no more on some devices.
        nbytes = -(-16 * placement.cells // BufferPart.ALIGNMENT) * BufferPart.ALIGNMENT
        self._refined = Buffer(gpu, "furnace corrections and bounced light", 2 * nbytes)
        self.corrections = BufferPart(self._refined, 0, 16 * placement.cells)
        self.bounced = BufferPart(self._refined, nbytes, 16 * placement.cells)
        self._emission = _Emission(gpu, mix, has_blocks=True)
        self._furnace = _Furnace(gpu, mix, has_blocks=False)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        eye: F64,
        table: OrdinateTable,
        passed: Buffer,
        diffuse: Buffer,
        reach: Buffer,
        correction: float,
    ) -> None:
        """For an eye at `eye` (3,), m in the medium's frame."""
        self._emission.dispatch(
            commands,
            (self.cells,),
            params=params,
            **seen_by(table, eye, correction),
            passed=passed,
            diffuse=diffuse,
            reach=reach,
            refined=self._refined,
            emission=self.texture,
            **self._mix.beam_bound,
        )

    def encode_furnace(
        self,
        commands: Commands,
        params: MediumParams,
        eye: F64,
        table: OrdinateTable,
        passed: Buffer,
        diffuse: Buffer,
        reach: Buffer,
        white: Mix,
    ) -> None:
        """Fill `corrections` from the same medium without absorption under an even sky of 1."""
        self._furnace.dispatch(
            commands,
            (self.cells,),
            params=params,
            **seen_by(table, eye, 0.0),
            passed=passed,
            diffuse=diffuse,
            reach=reach,
            corrections=self.corrections,
            **white.beam_bound,
        )


def seen_by(table: OrdinateTable, eye: F64, correction: float) -> dict[str, Any]:
    """The light and the eye, as emission binds them."""
    gain = table.gain
    view = ViewParams(eye=eye, correction=correction, sky_from_medium=gain.sky_from_medium)
    return {
        "view": view,
        "ordinates": table.rows,
        "phase": table.phase,
        "sky_gain": gain.texture,
        "sky_sampler": gain.sampler,
    }
