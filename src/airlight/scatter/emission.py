"""The solved track as textures: what marching reads.

Three textures (one per channel) hold (V_a, 3 V_b) times a scale. With cells of side s,
V_a/s^3 is fluence and V_b/s^3 net flux, so in two bands radiance is (V_a + 3 V_b.w)/(4 pi s^3);
marching weighs its second band by g. A fourth holds V_a of the three channels as rgb: mean
radiance, for those who march a colour. Nested lattices share the textures, one above the other.
"""

from __future__ import annotations

import math
from typing import Any

from ..fields import ForwardSource, LatticeSource
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import FILTERED, image, storage, uniform
from ..lattice.lookup import CHANNEL_IMAGES, ChannelTextures
from ..lattice.placement import Placement
from ..maths.half import half_scale
from ..maths.lattice26 import true_share
from ..scene.checks import Rgb


class EmissionParams(Struct):
    """The lattice's size and scales."""

    count = vec3u("cells")
    scale = f32("stored units per W m of track")
    share = vec3f("of the lattice's track that there truly is")
    first_row = u32("where its cells begin along y of the textures")
    has_forward = u32("1: light scattered forwards comes on top")


class _Pack(ComputePass):
    slots = (
        uniform("params", EmissionParams),
        storage("track", "vec4f"),
        storage("forward", "vec4f"),
        *CHANNEL_IMAGES,
        image("mean", FILTERED, "3d"),
    )
    workgroup = (32, 8, 1)
    file = "emission.wgsl"


class Emission(ChannelTextures):
    """What solved lattices hand on; `placement` is the largest one's, which stays."""

    def __init__(
        self, gpu: Gpu, placement: Placement, size: tuple[int, int, int] | None = None
    ) -> None:
        """`size` in cells: of all lattices that share the textures; else the lattice's own."""
        size = size or placement.count
        super().__init__(gpu, "track", size)
        self.placement, self.scale = placement, 1.0
        self._pack = _Pack(gpu)
        # Beside three channels of two bands, means for media that scatter isotropically.
        self.mean = Texture(gpu, "track mean", size, FILTERED, dimension="3d", written=True)

    def encode(
        self,
        commands: Commands,
        track: Buffer,
        flux: float,
        forward: Buffer | None = None,
        *,
        sigma_t: Rgb = (math.inf, math.inf, math.inf),
        placement: Placement | None = None,
    ) -> None:
        """Fill the textures; `flux`, W, bounds what came into the lattice.

        `forward`: more track, of light that never was in it. `sigma_t`, m^-1, says how much of the
        track is true (maths.lattice26.true_share), by default all. `placement`: which of the
        lattices that share the textures.
        """
        # As bright as half floats hold even if all flux lies in one cell. Marching knows by how
        # much the faces of finer cells are smaller; their sides are left.
        largest, placement = self.placement.cell, placement or self.placement
        self.scale = half_scale(flux * largest)
        # One scale for all lattices, such that half floats hold the light that there is.
        params = EmissionParams(
            count=placement.count,
            scale=self.scale * largest / placement.cell,
            has_forward=int(forward is not None),
            share=true_share(sigma_t, placement.cell).tolist(),
            first_row=placement.first_row,
        )
        self._pack.dispatch(
            commands,
            placement.count,
            params=params,
            track=track,
            forward=forward or track,
            **self.written,
            mean=self.mean,
        )

    @property
    def mean_scale(self) -> float:
        """W m^-2 sr^-1 of mean radiance per stored unit of the largest lattice's `mean`; times
        sigma_s it is J.
        """
        return 1.0 / (4.0 * math.pi * self.placement.cell**3 * self.scale)

    def source(
        self,
        walls: dict[str, Any],
        forward: ForwardSource | None = None,
        *,
        finer: tuple[Placement, ...] = (),
        is_reduced_medium: bool = False,
    ) -> LatticeSource:
        """For marching; `walls` as Blockers.bound, the rest as LatticeSource has it."""
        return LatticeSource(
            self.placement,
            self.bound | walls,
            self.mean_scale,
            finer=finer,
            forward=forward,
            mean=self.mean,
            is_reduced_medium=is_reduced_medium,
        )
