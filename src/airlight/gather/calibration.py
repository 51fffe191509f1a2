"""How bright the lattices' light is beside the light that paths trace: one factor for an image.

Where the second last segment of a path ends, the lattices' irradiance is known and so is an
estimate of the same light: what the last segment finds. On the mean of all paths, weighted by what
each would bring to the eye, both must agree (`maths.gather.calibration`). So a lattice that is too
bright or too dark as a whole, for its cells are large or light turns too much in them, is put
right by what was traced anyway.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform

RAYS = 4
"""Of each point and sample, the first: what the factor is measured with. They are in the first
batch of rays, so that it does not depend on how many a device holds."""
_PARTS = 4096  # partial sums


class MeasureParams(Struct):
    """How many paths there are."""

    paths = u32()


class CalibrateParams(Struct):
    """How many paths there are, and in how many columns they are worked on."""

    paths = u32()
    width = u32()


class _Measure(ComputePass):
    slots = (
        uniform("params", MeasureParams),
        storage("shares", "vec4f"),
        storage("parts", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "calibration_sums.wgsl"


class _Factor(ComputePass):
    slots = (storage("parts", "vec4f"), storage("factor", "f32", "read_write"))
    workgroup = (64, 1, 1)
    file = "calibration.wgsl"


class _Apply(ComputePass):
    slots = (
        uniform("params", CalibrateParams),
        storage("factor", "f32"),
        storage("paths", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "calibrated.wgsl"


class Calibration:
    """`shares` of each of `count` paths, as `fold.wgsl` leaves them, and the factor they ask."""

    def __init__(self, gpu: Gpu, count: int) -> None:
        # What lattices and traced light say of each path, and the factor on which both agree.
        self.shares = Buffer(gpu, "lattice shares of paths", 16 * count)
        self.factor = Buffer(gpu, "lattice factor", 16)
        self._parts = Buffer(gpu, "lattice shares", 16 * _PARTS)
        constants = {"PARTS": float(_PARTS)}
        self._measure = _Measure(gpu, constants=constants)
        self._factor = _Factor(gpu, constants=constants)
        self._apply = _Apply(gpu)

    def measure(self, commands: Commands, count: int) -> None:
        """Find the factor that the first `count` paths ask."""
        self._measure.dispatch(
            commands,
            (_PARTS,),
            params=MeasureParams(paths=count),
            shares=self.shares,
            parts=self._parts,
        )
        self._factor.dispatch(commands, (64,), parts=self._parts, factor=self.factor)

    def apply(self, commands: Commands, paths: Buffer, count: int) -> None:
        """Add to `count` paths what lattices know of their ends, times the factor."""
        # Paths lie in rows, since a dispatch is limited along each axis.
        width = min(count, 1 << 16)
        self._apply.dispatch(
            commands,
            (width, -(-count // width)),
            params=CalibrateParams(paths=count, width=width),
            factor=self.factor,
            paths=paths,
        )
