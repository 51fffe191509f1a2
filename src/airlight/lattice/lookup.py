"""The solved lattice as filtered 3D textures, which `wgsl/lattice.wgsl` reads.

Three textures, one per channel, hold (a, bx, by, bz), scaled so that the whole flux in one cell
fits into half floats.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import FILTERED, Slot, image, storage, texture, uniform
from ..maths.half import half_scale
from ..maths.lattice6 import LOOKUP_SCALE
from .inject import forward_share
from .lobes import SHAPED_LOBE
from .placement import EVERYWHERE, Hull, Placement

CHANNEL_SLOTS: tuple[Slot, ...] = tuple(
    texture(f"lattice_{channel}", "3d") for channel in ("red", "green", "blue")
)
"""Of passes that use `wgsl/lattice.wgsl`; `ChannelTextures.bound` binds them."""
CHANNEL_IMAGES: tuple[Slot, ...] = tuple(
    image(channel, FILTERED, "3d") for channel in ("red", "green", "blue")
)
"""Of passes that fill such textures; `ChannelTextures.written` binds them."""


class PackParams(Struct):
    """The lattice's placement and the scale of its textures."""

    count = vec3u("cells")
    scale = f32("stored units per W sr^-1")
    own_constant = f32("share of the injected a that surfaces in the cell see")
    own_directional = f32("share of the injected b")
    first_row = u32("where its cells begin along y of the textures")
    origin = vec3f("m")
    cell = f32("m")
    low = vec3f("m along its axes, as the origin: corner of a box beyond which it is dark")
    high = vec3f("m")
    beams = f32("W sr^-1 per W m of beams; 0: there are none")
    is_finest = u32("1: no finer lattice takes in its light, and no cell shows less than none")


class Pack(ComputePass):
    """injected + propagated + beams -> three textures."""

    slots = (
        uniform("params", PackParams),
        storage("injected", "vec4f"),
        storage("propagated", "vec4f"),
        storage("beams", "vec4f"),
        *CHANNEL_IMAGES,
    )
    workgroup = (32, 8, 1)
    file = "pack.wgsl"


class ChannelTextures:
    """A state (a, bx, by, bz) per cell, with a texture for each colour channel.

    `wgsl/lattice.wgsl` reads them; solvers differ in how they fill them.
    """

    def __init__(self, gpu: Gpu, name: str, size: tuple[int, int, int]) -> None:
        """`size` in cells (x, y, z)."""

        def made(channel: str) -> Texture:
            label = f"{name} {channel}"
            return Texture(gpu, label, size, FILTERED, dimension="3d", written=True)

        self.red, self.green, self.blue = made("red"), made("green"), made("blue")

    @property
    def bound(self) -> dict[str, Texture]:
        """By the names of CHANNEL_SLOTS."""
        return {"lattice_red": self.red, "lattice_green": self.green, "lattice_blue": self.blue}

    @property
    def written(self) -> dict[str, Texture]:
        """By the names of CHANNEL_IMAGES."""
        return {"red": self.red, "green": self.green, "blue": self.blue}


class LatticeStates(NamedTuple):
    """States of cells: injected, propagated; and `beams`, the fluence and flux, W m, of light that
    the lattice does not hold."""

    injected: Buffer
    propagated: Buffer
    beams: Buffer | None = None


class LatticeTextures(ChannelTextures):
    """The textures of a solved lattice; nested lattices share them."""

    def __init__(
        self, gpu: Gpu, placement: Placement, size: tuple[int, int, int] | None = None
    ) -> None:
        """`size` in cells: of all lattices that share the textures; else the lattice's own."""
        super().__init__(gpu, "lattice", size or placement.count)
        self.placement = placement
        self.pack = Pack(gpu)

    def encode(
        self,
        commands: Commands,
        light: LatticeStates,
        scale: float,
        *,
        is_shaped: bool,
        placement: Placement | None = None,
        hull: Hull = EVERYWHERE,
    ) -> None:
        """Fill the textures; `scale` as from `texture_scale`, `is_shaped` as for the lobes.

        `placement`: which of the lattices that share the textures. `hull`: cells outside it are
        dark.
        """
        placement = placement or self.placement
        # A shaped lobe is narrower than what a surface in its own cell should read of it.
        constant, directional = own_shares() if is_shaped else (1.0, 1.0)
        # Injected and propagated light together, in half floats, a texture for each colour.
        self.pack.dispatch(
            commands,
            placement.count,
            params=PackParams.of(
                count=placement.count,
                scale=scale,
                own_constant=constant,
                own_directional=directional,
                first_row=placement.first_row,
                origin=placement.origin,
                cell=placement.cell,
                low=hull[0],
                high=hull[1],
                # Fluence is read off as irradiance, whatever the lookup's scale.
                beams=1.0 / (4.0 * math.pi * LOOKUP_SCALE * placement.cell) if light.beams else 0.0,
                # Lattices share the textures, the finest first.
                is_finest=int(placement.first_row == 0),
            ),
            injected=light.injected,
            propagated=light.propagated,
            beams=light.beams or light.propagated,
            **self.written,
        )


def texture_scale(flux: float) -> float:
    """Stored units per W sr^-1 for a lattice into which `flux` (W) comes."""
    return half_scale(flux / (4.0 * math.pi))


def own_shares() -> tuple[float, float]:
    """The factors that turn a shaped lobe into the one that surfaces in its own cell read.

    A flat surface must not light itself: a - (2/3) b.n = 0 asks for b = 3/2 a n.
    """
    # The power that leaves in front, and the b at which a flat surface sees nothing of itself.
    whole = forward_share()
    return whole, whole * 1.5 / SHAPED_LOBE
