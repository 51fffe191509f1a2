"""How lattices are kept between steps: float32, float16, or a byte per coefficient.

Kaplanyan2010 section 6 keeps them as half floats, and as QUVW8 (four signed bytes) on consoles.
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
    """A lattice's element: its WGSL type, its size and how four coefficients become one."""

    element: str
    nbytes: int
    unpacked: str
    packed: str
    largest: float  # what the largest injected coefficient becomes; 0: it stays as it is
    functions: str = ""

    @property
    def wgsl(self) -> str:
        """`unpacked(element) -> vec4f` and `packed(vec4f) -> element`."""
        return (
            f"{self.functions}"
            f"fn unpacked(v: {self.element}) -> vec4f {{ return {self.unpacked}; }}\n"
            f"fn packed(v: vec4f) -> {self.element} {{ return {self.packed}; }}\n"
        )


# Half a step of the logarithm is 6%: over a lattice of cells it averages out.
_BYTES = """
const FAINTEST = -18.0;     // log2 of |a|; what is below is nothing
const BRIGHTEST = 4.0;
const FIRST = 1.0 / 127.0;  // the faintest; 0 is none
fn from_bytes(v: u32) -> vec4f {
    let s = unpack4x8snorm(v);
    let place = (abs(s.x) - FIRST) / (1.0 - FIRST);
    let a = sign(s.x) * exp2(mix(FAINTEST, BRIGHTEST, place));
    return a * vec4f(1.0, 3.0 * s.yzw);
}
fn to_bytes(v: vec4f) -> u32 {
    let a = abs(v.x);
    let place = saturate((log2(max(a, 1e-30)) - FAINTEST) / (BRIGHTEST - FAINTEST));
    let code = select(0.0, mix(FIRST, 1.0, place), a >= exp2(FAINTEST));
    return pack4x8snorm(vec4f(sign(v.x) * code, v.yzw / (3.0 * select(1.0, v.x, a > 0.0))));
}
"""

FORMATS = {
    "float32": Format("vec4f", 16, "v", "v", 0.0),
    # Sums of eight states must fit too; half floats go to 65504.
    "float16": Format(
        "vec2u",
        8,
        "vec4f(unpack2x16float(v.x), unpack2x16float(v.y))",
        "vec2u(pack2x16float(v.xy), pack2x16float(v.zw))",
        1024.0,
    ),
    "8bit": Format("u32", 4, "from_bytes(v)", "to_bytes(v)", 1.0, _BYTES),
}


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
