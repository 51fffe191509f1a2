"""Light that has scattered once close to a lamp, which beams and diffusion miss.

See `maths.lamp_beam.near_fluence`; added to the diffuse fluence, whose net flux is right already.
"""

from __future__ import annotations

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ...maths.delta_beam import beam_loss, forward_share
from ...maths.lamp_beam import NEAR_TABLE, near_table
from ..light.ordinates import OrdinateData
from ..medium.mixture import Mix
from ..medium.placement import MediumParams


class NearLight(ComputePass):
    """Adds what all lamps' surroundings miss to `diffuse`."""

    workgroup = (64, 1, 1)

    def __init__(self, gpu: Gpu, mix: Mix) -> None:
        self._mix = mix
        self.slots = (  # type: ignore[misc]
            uniform("params", MediumParams),
            storage("ordinates", OrdinateData),
            *mix.beam_slots,
            storage("passed", "f32"),
            storage("missing", "vec4f"),
            storage("diffuse", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=mix.beam_wgsl(has_blocks=False))
        self._table = Buffer(gpu, "near a lamp", 16 * NEAR_TABLE)
        self._written: tuple[float, ...] = ()

    def write(self, g: tuple[float, ...], albedo: tuple[float, ...]) -> None:
        """Take a medium's phase function and albedo."""
        if (*g, *albedo) == self._written:
            return
        self._written = (*g, *albedo)
        staying = np.asarray(albedo) * (1.0 - forward_share(g))
        texels = np.zeros((NEAR_TABLE, 4), np.float32)
        for channel, ratio in enumerate(staying / np.maximum(beam_loss(g, albedo), 1e-12)):
            texels[:, channel] = near_table(float(ratio))
        self._table.write(texels)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        cells: int,
        *,
        ordinates: Buffer,
        passed: Buffer,
        diffuse: Buffer,
    ) -> None:
        """Cell by cell, over all lamps among the ordinates."""
        self.dispatch(
            commands,
            (cells,),
            params=params,
            ordinates=ordinates,
            passed=passed,
            missing=self._table,
            diffuse=diffuse,
            **self._mix.beam_bound,
        )
