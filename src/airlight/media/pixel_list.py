"""A list of pixels on the device, which an indirect dispatch redraws."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Buffer
from ..gpu.slots import Slot, storage, uniform

# A pixel, and the sky's light that its shafts are added to: four words.
_ENTRY_BYTES = 16


class RedrawParams(Struct):
    """Which pixels of an image from reduced texels are redrawn."""

    contrast = f32("(most - least)/most among the texels of a pixel, beyond which it is redrawn")
    group = u32("pixels of a workgroup of the pass that redraws them")


def pixel_list_slots() -> tuple[Slot, ...]:
    """The slots of passes that use wgsl/pixel_list.wgsl."""
    return (
        uniform("redrawn", RedrawParams),
        storage("found", "atomic<u32>", "read_write"),
        storage("groups", "atomic<u32>", "read_write"),
        storage("chosen", "vec4u", "read_write"),
    )


class PixelList:
    """How many pixels there are (`found`), how many workgroups redraw them (`groups`), and which.

    `chosen`: vec4u per pixel, radiance to add to it as the bits of rgb, and its packed position.
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        """`size` of the image, pixels: all of them may be listed."""
        self.gpu = gpu
        self.found = Buffer(gpu, "differing pixels", 16)
        self.groups = Buffer(gpu, "groups of them", 16, indirect=True)
        # The arguments of a dispatch of no groups, of which x is counted up.
        self._none = Buffer(gpu, "no groups", 16)
        self._none.write(np.array([0, 1, 1, 0], np.uint32))
        self._make(size)

    def _make(self, size: tuple[int, int]) -> None:
        self.chosen = Buffer(self.gpu, "list of them", _ENTRY_BYTES * size[0] * size[1])

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with images of `size`, pixels."""
        self.chosen.release()
        self._make(size)

    def begin(self, commands: Commands) -> None:
        """Empty the list."""
        commands.encoder.clear_buffer(self.found.handle)
        commands.encoder.copy_buffer_to_buffer(self._none.handle, 0, self.groups.handle, 0, 16)

    @property
    def bound(self) -> dict[str, Any]:
        """The resources of the pass that lists, by slot name."""
        return {"found": self.found, "groups": self.groups, "chosen": self.chosen}
