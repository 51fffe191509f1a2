"""Mirrored light of glossy pixels on CPU adapters: lighting lists them, this pass traces them.

CPU adapters run both sides of every branch, so tracing mirrored rays within lighting would cost
every pixel of the image what it costs the glossy ones.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.demands import largest_binding
from ..gpu.device import Gpu
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import image, storage
from .kernel import LatticeLight
from .slots import LATTICE_SLOTS, SURFACE_SLOTS

# Two vec4: what the pixel has, where it is, and how much it mirrors.
_ENTRY_BYTES = 32
_AT_ONCE = (2048, 1, 1)  # each goes on with every 2048th of the list


def can_list(gpu: Gpu, size: tuple[int, int]) -> bool:
    """Whether a device lets a list hold all pixels of an image."""
    return _ENTRY_BYTES * size[0] * size[1] <= largest_binding(gpu)


class _Mirrored(ComputePass):
    slots = (
        *SURFACE_SLOTS,
        *LATTICE_SLOTS,
        storage("found", "u32"),
        storage("listed", "vec4u"),
        image("direct_light", "rgba32float"),
        image("indirect_light", "rgba32float"),
    )
    workgroup = (64, 1, 1)
    file = "glossy_pixels.wgsl"


class GlossyPixels:
    """The list of an image's glossy pixels, and their mirrored light."""

    def __init__(self, gpu: Gpu, lattices: LatticeLight) -> None:
        """As for `Lighting`."""
        self.gpu = gpu
        self._pass = _Mirrored(
            gpu,
            constants={**lattices.constants, "HAS_GLOSS": 1.0, "IS_LISTED": 1.0},
        )
        self._found = Buffer(gpu, "glossy pixels", 16)
        self._listed: Buffer | None = None

    def empty(self, commands: Commands, size: tuple[int, int]) -> dict[str, Any]:
        """An empty list for an image of `size`, pixels, by the slot names of `Lighting`."""
        # A list has room for all pixels of the image.
        nbytes = _ENTRY_BYTES * size[0] * size[1]
        if self._listed is None or self._listed.nbytes != nbytes:
            if self._listed is not None:
                self._listed.release()
            self._listed = Buffer(self.gpu, "list of glossy pixels", nbytes)
        commands.encoder.clear_buffer(self._found.handle)
        return {"found": self._found, "listed": self._listed}

    def encode(
        self, commands: Commands, targets: tuple[Texture, Texture], values: dict[str, Any]
    ) -> None:
        """Write all light of the listed pixels to `targets`; `values` as for `Lighting.light`."""
        # Bound as for lighting, but for the targets, which it writes as images.
        names = {slot.name for slot in self._pass.slots} - {"direct_light", "indirect_light"}
        bound = {name: value for name, value in values.items() if name in names}
        direct, indirect = targets
        self._pass.dispatch(
            commands,
            _AT_ONCE,
            **bound,
            direct_light=direct,
            indirect_light=indirect,
        )
