"""The eye ray of each texel of a full or reduced image, and the distance to its surface.

A texel of a reduced image takes one pixel of its block as it is. Where the depths of the block
differ, texels take the nearest and the farthest one in a chessboard pattern, so that upsampling
finds both sides of an edge.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, mat4x4f, u32, vec2u, vec3f
from ..gpu.memory import Texture
from ..gpu.slots import texture, uniform
from ..lighting.view import View

RESOLUTIONS = {"full": 1, "half": 2, "quarter": 4}


class RayParams(Struct):
    """The camera, and the sizes of the full and of the reduced image."""

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    scale = u32("pixels along one side of a texel")
    size = vec2u("px")
    reduced = vec2u("px")
    frame = u32("number of the frame, for noise")


class _Rays(FullscreenPass):
    slots = (
        uniform("rays", RayParams),
        texture("depth", "2d", "depth"),
    )
    targets = ("rg32float",)


class Rays:
    """The rays of an image that was encoded last; passes over them read `params` and `picked`.

    `picked`: per texel, the distance (m) to the surface and the pixel in its block.
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int], scale: int) -> None:
        self.gpu, self.scale = gpu, scale
        self._params: RayParams | None = None
        self._set_size(size)
        self._pass = _Rays(gpu)

    def _set_size(self, size: tuple[int, int]) -> None:
        self.size, scale = size, self.scale
        # The last texels may reach beyond the image.
        self.reduced = (-(-size[0] // scale), -(-size[1] // scale))
        self.picked = Texture(
            self.gpu, "picked rays", self.reduced, "rg32float", target=True, written=True
        )

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with images of `size`, pixels."""
        self.picked.release()
        self._set_size(size)

    @property
    def params(self) -> RayParams:
        """The slot `rays` of passes over them."""
        assert self._params is not None, "no rays were encoded"
        return self._params

    def encode(self, commands: Commands, view: View, frame: int = 0) -> None:
        """Pick the rays of `view`."""
        # Passes over these rays read the same parameters until the next image.
        self._params = RayParams(
            world_from_clip=view.world_from_clip,
            eye=view.eye,
            scale=self.scale,
            size=self.size,
            reduced=self.reduced,
            frame=frame,
        )
        # Which pixel of its block each ray goes through.
        self._pass.draw(
            commands,
            (self.picked,),
            rays=self._params,
            depth=view.gbuffer.depth,
        )
