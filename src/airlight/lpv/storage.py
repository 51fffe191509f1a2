"""How lattices are stored between steps: float32, float16, or a byte per coefficient.

Kaplanyan2010 section 6 stores them as half floats, and as QUVW8 (four signed bytes) on consoles.
Both need light of a known range: it is scaled so that the largest injected coefficient takes a
value of the format's own, and scaled back where it is added to the sum, which stays float32.
differs: plain signed bytes lose all light below 1/254 of the brightest (measured: half of it in
64 steps). Here the first byte holds the logarithm of a, the others b / 3a.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform

STORAGES = ("float32", "float16", "8bit")


@dataclass(frozen=True)
class Format:
    """How a lattice stores the two bands of a cell; its WGSL is `wgsl/state_NAME.wgsl`."""

    name: str
    element: str
    nbytes: int
    largest: float  # what the largest injected coefficient becomes; 0: it stays as it is

    @property
    def wgsl(self) -> str:
        """`State`, `unpacked(State) -> vec4f` and `packed(vec4f) -> State`."""
        return f"//! use state_{self.name}\n"


FORMATS = {
    format.name: format
    for format in (
        Format("float32", "vec4f", 16, 0.0),
        # Sums of eight states must fit too; half floats go to 65504.
        Format("float16", "vec2u", 8, 1024.0),
        Format("8bit", "u32", 4, 1.0),
    )
}
FLOAT = FORMATS["float32"]


class RangeParams(Struct):
    """What is searched, and what its largest value shall become."""

    values = u32("vec4 values in the lattice")
    largest = f32("stored units")


class _Range(ComputePass):
    """range[0] = stored units per W sr^-1, a power of two."""

    slots = (
        uniform("params", RangeParams),
        storage("lattice", "vec4f"),
        storage("range", "f32", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "range.wgsl"


class Pack:
    """Lattices of float32 into another format, scaled to its range."""

    def __init__(self, gpu: Gpu, name: str) -> None:
        """`name` is one of STORAGES."""
        self.format = FORMATS[name]
        self.range = Buffer(gpu, "range of lattices", 16)
        self._range = _Range(gpu)
        self._pack = _pack_pass(gpu, self.format)

    def encode(self, commands: Commands, lattice: Buffer, stored: Buffer, values: int) -> None:
        """Find the scale for `lattice` (`values` vec4f) and write it to `stored`."""
        params = RangeParams(values=values, largest=self.format.largest)
        self._range.dispatch(commands, (1,), params=params, lattice=lattice, range=self.range)
        self._pack.dispatch(
            commands, (values,), params=params, lattice=lattice, range=self.range, stored=stored
        )


def _pack_pass(gpu: Gpu, format: Format) -> ComputePass:
    class PackLattice(ComputePass):
        slots = (
            uniform("params", RangeParams),
            storage("lattice", "vec4f"),
            storage("range", "f32"),
            storage("stored", format.element, "read_write"),
        )
        workgroup = (256, 1, 1)
        file = "store.wgsl"

    return PackLattice(gpu, generated=format.wgsl)
