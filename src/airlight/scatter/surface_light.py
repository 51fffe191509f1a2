"""The summed states as textures, for lighting surfaces as lattice.lookup's are.

The medium shortens the track that a state leaves, and so the light that reaches a wall, by
mean_track's share. The more of it comes from the medium and not from a few lit surfaces, the nearer
is what lights a wall to what the hops bring to it (maths.lattice26.scattered_lookup_scale).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.lookup import CHANNEL_IMAGES, ChannelTextures
from ..lattice.placement import LatticeParams, Placement
from ..maths.half import half_scale
from ..maths.lattice26 import LOOKUP_SCALE, mean_hop_length, scattered_lookup_scale
from ..scene.checks import Rgb


class SurfaceLightParams(Struct):
    """The lattice's size, its scale and its medium."""

    count = vec3u("cells")
    cell = f32("m")
    sigma_t = vec3f("m^-1, where the medium is homogeneous")
    chord = f32("m, mean path through the largest lattice")
    sigma_s = vec3f("m^-1, likewise")
    scale = f32("stored units per W of state in clear air, and per m of mean track there")
    is_varied = u32()
    forward = f32("stored units per W m of light scattered forwards; 0: there is none")
    first_row = u32("where its cells begin along y of the textures")


class _Pack(ComputePass):
    slots = (
        uniform("params", SurfaceLightParams),
        storage("total", "vec4f"),
        storage("medium", "vec2f"),
        storage("forward", "vec4f"),
        *CHANNEL_IMAGES,
    )
    workgroup = (32, 8, 1)
    file = "surface_light.wgsl"


@dataclass(frozen=True, eq=False)
class SurfaceMedium:
    """A lattice's medium: homogeneous, m^-1, or (sigma_s, sigma_t) of each of its `cells`."""

    sigma_s: Rgb = (0.0, 0.0, 0.0)
    sigma_t: Rgb = (0.0, 0.0, 0.0)
    cells: Buffer | None = None


NO_MEDIUM = SurfaceMedium()


class SurfaceLight(ChannelTextures):
    """Three textures that `wgsl/lattice.wgsl` reads; nested lattices share them.

    `placement` is the largest lattice's.
    """

    def __init__(
        self, gpu: Gpu, placement: Placement, size: tuple[int, int, int] | None = None
    ) -> None:
        """`size` in cells: of all lattices that share the textures; else the lattice's own."""
        super().__init__(gpu, "surface", size or placement.count)
        self.placement, self.scale = placement, 1.0
        # By how much more walls get where all light comes from the medium.
        gain = scattered_lookup_scale() / LOOKUP_SCALE - 1.0
        self._pack = _Pack(gpu, constants={"SCATTERED_GAIN": gain})

    def encode(
        self,
        commands: Commands,
        total: Buffer,
        flux: float,
        medium: SurfaceMedium,
        *,
        forward: Buffer | None = None,
        placement: Placement | None = None,
    ) -> None:
        """From the sum of states; `flux`, W, bounds what came in.

        `forward`: fluence and flux, W m, of beams that the lattice does not hold. `placement`:
        which of the lattices that share the textures.
        """
        placement = placement or self.placement
        # As bright as half floats hold even if all flux lies in one cell.
        self.scale = half_scale(flux)
        # A state lights walls by the track that it leaves, in clear air that of a mean hop.
        clear_m = mean_hop_length() * placement.cell
        params = SurfaceLightParams(
            count=placement.count,
            cell=placement.cell,
            first_row=placement.first_row,
            sigma_t=medium.sigma_t,
            sigma_s=medium.sigma_s,
            chord=_mean_chord(self.placement),
            scale=self.scale / clear_m,
            is_varied=int(medium.cells is not None),
            # Fluence is read off as irradiance by surface_irradiance, whatever the lookup's scale.
            forward=self.scale / (LOOKUP_SCALE * placement.cell) if forward else 0.0,
        )
        self._pack.dispatch(
            commands,
            placement.count,
            params=params,
            total=total,
            medium=medium.cells or total,
            forward=forward or total,
            **self.written,
        )

    def params(self, placement: Placement | None = None) -> LatticeParams:
        """The `lattice` with which wgsl/lattice.wgsl reads irradiance off these textures."""
        # Textures hold power, lattice.wgsl reads intensity.
        placement = placement or self.placement
        return placement.params(self.scale * 4.0 * math.pi, lookup_scale=LOOKUP_SCALE)


def _mean_chord(placement: Placement) -> float:
    """4 V/S of a lattice, m."""
    x, y, z = (n * placement.cell for n in placement.count)
    return 2.0 * x * y * z / (x * y + y * z + z * x)
