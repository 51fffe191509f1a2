"""Work whose amount is known on the device alone: rows of an image, the first ones, that are used.

A CPU adapter runs all of a pass for texels that it then leaves out: a masked lane takes the time of
any other. So what is listed on the device lies in the first rows of its image, and passes run on
these: compute passes by an indirect dispatch, full-screen passes by stripes of the image, of which
an indirect draw draws as many as reach so far.
"""

from __future__ import annotations

from .device import Gpu
from .memory import Buffer

STRIPES = 64
"""Parts of an image's height, of which a pass draws the first."""
FIRST_CORNER = 3
"""The number of a stripe's first vertex: those before are the triangle's over the whole image."""
_DRAW_AT = 16


class CountedRows:
    """How many rows of an image there are to be worked on: arguments that a kernel writes.

    `arguments` holds eight u32: workgroups along x, y, z of 8 x 8 texels and one that is unused;
    then vertices, stripes, FIRST_CORNER and zero. `wgsl/counted_rows.wgsl` writes them.
    """

    def __init__(self, gpu: Gpu, label: str) -> None:
        self.arguments = Buffer(gpu, label, 32, indirect=True)

    def draw(self, encoder: object) -> None:
        """Draw their stripes in a render pass whose pipeline and bindings are set."""
        encoder.draw_indirect(self.arguments.handle, _DRAW_AT)  # type: ignore[attr-defined]
