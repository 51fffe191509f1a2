"""Light that has scattered once close to a local light, which beams and diffusion miss.

See `maths.point_light_beam.near_fluence`; it is added to the diffuse fluence, whose net flux is
right already.
"""

from __future__ import annotations

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ...maths.delta_beam import beam_loss
from ...maths.outgoing_light import forward_share
from ...maths.point_light_beam import NEAR_TABLE, near_table
from ..light.incident import IncidentLight
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams


class NearLight(ComputePass):
    """Adds the missing fluence around all local lights to `diffuse`."""

    workgroup = (64, 1, 1)

    def __init__(self, medium: GridMedium, light: IncidentLight) -> None:
        mixture = light.mixture
        self._medium, self._light = medium, light
        self.slots = (
            uniform("params", MediumParams),
            *light.slots,
            storage("missing", "vec4f"),
            storage("diffuse", "vec4f", "read_write"),
        )
        # Local lights alone count here, so blocks of other media are left out.
        super().__init__(medium.gpu, generated=mixture.beam_wgsl(has_blocks=False))
        self._table = Buffer(medium.gpu, "near a local light", 16 * NEAR_TABLE)
        self._written: tuple[float, ...] = ()

    def write(self, g: tuple[float, ...], albedo: tuple[float, ...]) -> None:
        """Tabulate the missing fluence of a medium, unless it is the last one."""
        if (*g, *albedo) == self._written:
            return
        self._written = (*g, *albedo)
        # Of what leaves a beam, the share that is not scattered forwards, channel by channel.
        staying = np.asarray(albedo) * (1.0 - forward_share(g))
        texels = np.zeros((NEAR_TABLE, 4), np.float32)
        for channel, ratio in enumerate(staying / np.maximum(beam_loss(g, albedo), 1e-12)):
            texels[:, channel] = near_table(float(ratio))
        self._table.write(texels)

    def encode(self, commands: Commands, params: MediumParams, diffuse: Buffer) -> None:
        """Sum over all local lights among the ordinates, cell by cell."""
        light = self._light
        self.dispatch(
            commands,
            (self._medium.cells,),
            params=params,
            missing=self._table,
            diffuse=diffuse,
            **light.bound,
        )
