"""Light that enters a finer lattice from the larger one around it.

The larger lattice is solved first. Cells along the finer one's sides get what neighbours beyond the
border, in states that bring the fluence of the larger lattice there, would send them in one hop:
the source of the finer lattice then holds all light that comes in, and its own steps go on with it.
The solution of a lattice cut out of another is then the other's.
differs: Billeter2012 has one lattice; Kaplanyan2010 section 4.1 propagates every lattice alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, vec3f
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.blockers import BLOCKER_SLOTS
from ..lattice.placement import LatticeParams, Placement
from ..scene.checks import Rgb
from .coefficients import CHANNELS, StepCoefficients
from .propagate import Operator, StepMedium, StepParams


class OuterParams(Struct):
    """The medium between lattices."""

    sigma_t = vec3f("m^-1, where it is homogeneous")


class InjectOuter(ComputePass):
    """Adds the light that enters through the six sides to a lattice's source."""

    slots = (
        uniform("params", StepParams),
        uniform("outside", OuterParams),
        uniform("lattice", LatticeParams),
        uniform("outer", LatticeParams),
        *BLOCKER_SLOTS,
        storage("coefficients", StepCoefficients),
        storage("medium", "vec2f"),
        storage("outer_medium", "vec2f"),
        storage("outer_sum", "vec4f"),
        storage("cells", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "inject_outer.wgsl"

    def __init__(self, gpu: Gpu, *, is_varied: bool) -> None:
        """`is_varied`: whether the medium differs from cell to cell, as in both lattices."""
        super().__init__(gpu, constants={"IS_VARIED": float(is_varied)})

    def encode(
        self,
        commands: Commands,
        places: tuple[Placement, Placement],
        media: tuple[StepMedium, StepMedium],
        bound: Mapping[str, Any],
        *,
        outer_sum: Buffer,
        cells: Buffer,
        sigma_t: Rgb,
    ) -> None:
        """cells += what enters, W. `places` and `media` of the finer and of the larger lattice.

        `bound`: as Blockers.bound, which both share. `outer_sum`: the sum of all states of the
        larger one, W. `sigma_t`: m^-1, where the medium is homogeneous.
        """
        # The finer lattice's hops take states of the larger one across the border.
        (inner, outer), (own, around) = places, media
        x, y, z = own.count
        self.dispatch(
            commands,
            (x, y, CHANNELS * z),
            params=own.params(Operator.MOVE, slabs=z),
            outside=OuterParams.of(sigma_t=sigma_t),
            lattice=inner.params(),
            outer=outer.params(),
            coefficients=own.coefficients,
            medium=own.medium,
            outer_medium=around.medium,
            outer_sum=outer_sum,
            cells=cells,
            **bound,
        )
