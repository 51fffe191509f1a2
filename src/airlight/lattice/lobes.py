"""Lobes of virtual point lights, and the lattice they are added to: `wgsl/lobes.wgsl`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..maths.lattice6 import hops
from .placement import LatticeParams, Placement

COSINE_LOBE = 2.0
"""b = COSINE_LOBE P n / 4pi: the two-band fit of a clamped cosine (Ramamoorthi2001)."""
SHAPED_LOBE = 2.7
"""Where the surface itself blocks what would go backwards, a narrower lobe is the better one:
measured on a floor beside a wall, both blocking (relative L2 error 0.05; 0.12 at 2, 0.17 at 5)."""


@dataclass(frozen=True)
class Lobe:
    """The shape of a virtual point light's lobe: b = `sharpness` P n / 4pi.

    `is_shaped`: the surface blocks what goes backwards, and all power goes forward. `is_raised`:
    light of flat surfaces oblique to the cells enters a whole cell before them.
    """

    sharpness: float
    is_shaped: bool = False
    is_raised: bool = False
    free: float = 1.0
    """Of lobes that are not shaped: the sharpest of which no hop takes less than nothing."""


COSINE = Lobe(COSINE_LOBE)
SHAPED = Lobe(SHAPED_LOBE, is_shaped=True, is_raised=True)


class LobeParams(Struct):
    """How flux becomes integers, and the shape of a virtual point light's lobe."""

    scale = f32("fixed-point units per W sr^-1")
    lobe = f32("b / (P n / 4pi)")
    hop_constant = f32("share of an isotropic cell's power on one hop")
    hop_directional = f32("share of P b.n/|b| more on the hop along n, per unit of lobe")
    is_shaped = u32("1: the surface blocks what goes backwards")
    free = f32("the sharpest lobe of which no hop takes less than nothing, if not shaped")
    is_raised = u32("1: of flat surfaces oblique to the cells it enters a whole cell before them")


TARGET_SLOTS = (
    uniform("lobes", LobeParams),
    uniform("lattice", LatticeParams),
    texture("lattice_walls", "3d"),
    storage("sums", "atomic<i32>", "read_write"),
)
"""Of passes that use `wgsl/lobes.wgsl`; an `InjectionTarget` binds them."""


@dataclass(frozen=True, eq=False)
class InjectionTarget:
    """The lattice that light is injected into.

    `sums`: fixed-point, of `scale` units per W sr^-1. `walls`: as `Blockers.walls`.
    """

    placement: Placement
    walls: Texture
    sums: Buffer
    scale: float

    def bound(self, lobe: Lobe) -> dict[str, Any]:
        """By the names of TARGET_SLOTS."""
        return {
            "lobes": lobe_params(self.scale, lobe),
            "lattice": self.placement.params(),
            "lattice_walls": self.walls,
            "sums": self.sums,
        }


def lobe_params(scale: float, lobe: Lobe) -> LobeParams:
    """The parameters of `wgsl/lobes.wgsl`."""
    # Blocked lobes are scaled by what hops send forward.
    hop = hops("centroid")[0].matrix
    return LobeParams.of(
        scale=scale,
        lobe=lobe.sharpness,
        hop_constant=float(hop[0, 0]),
        hop_directional=float(hop[0, 1]),
        is_shaped=int(lobe.is_shaped),
        free=lobe.free,
        is_raised=int(lobe.is_raised),
    )
