"""Reduced pictures of air at full size, its transmittance and what is behind it, in one pass.

The same as `upsample`, `transmittance` and `compose` one after the other, where no density grid
asks for more: what they read of a pixel is read once, and nothing between them is written.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..gpu.raster import FullscreenPass
from ..gpu.slots import texture, uniform
from .air import Air
from .rays import RayParams

_TARGETS = ("direct", "indirect", "multiple", "transmittance")
_BYTES = 16  # of a pixel of one target
_SKY = """
fn skylit_at(texel: vec2i) -> vec3f { return textureLoad(skylit, texel, 0).rgb; }
fn set_single(out: ptr<function, Finished>, pixel: vec2i, sky: vec3f) {
    (*out).single = vec4f(textureLoad(shafts, pixel, 0).rgb + sky, 1.0);
}
"""
_NO_SKY = """
fn skylit_at(texel: vec2i) -> vec3f { return vec3f(0.0); }
fn set_single(out: ptr<function, Finished>, pixel: vec2i, sky: vec3f) {}
"""


def can_finish(gpu: Gpu) -> bool:
    """Whether a pass may have as many targets."""
    return gpu.limits["max-color-attachment-bytes-per-sample"] >= _BYTES * (len(_TARGETS) + 1)


class Finish(FullscreenPass):
    """Layers of surfaces and reduced pictures of air -> composed layers and those of the air.

    Reduced pictures hold how far each ray goes, m, as their alpha. `has_sky`: the sky's light
    scattered once is a reduced picture too, added to the shafts.
    """

    def __init__(self, gpu: Gpu, air: Air, *, has_sky: bool) -> None:
        self._air, self._has_sky = air, has_sky
        names = [*_TARGETS, *["single"] * has_sky]
        self.targets = ("rgba32float",) * len(names)  # type: ignore[misc]
        read = ["reduced", *["skylit", "shafts"] * has_sky, "direct", "indirect"]
        self.slots = (  # type: ignore[misc]
            uniform("rays", RayParams), texture("depth", "2d", "depth"), *air.medium_slots,
            *(texture(name, "2d", "unfilterable-float") for name in read),
        )  # fmt: skip
        fields = "".join(f"    @location({i}) {n}: vec4f,\n" for i, n in enumerate(names))
        made = f"struct Finished {{\n{fields}}}\n" + (_SKY if has_sky else _NO_SKY)
        super().__init__(gpu, generated=air.medium_wgsl + made)

    def encode(
        self, commands: Commands, params: RayParams, depth: Texture, *, reduced: Texture,
        skylit: Texture, shafts: Texture, direct: Texture, indirect: Texture,
        composed: tuple[Texture, Texture], multiple: Texture, transmittance: Texture,
        single: Texture,
    ) -> None:  # fmt: skip
        """Fill `composed` (direct, indirect), `multiple`, `transmittance` and, with a
        sky, `single` from what is read: `shafts` at full size, `reduced` and `skylit`.
        """
        sky = self._has_sky
        self.draw(
            commands, (*composed, multiple, transmittance, *[single] * sky), rays=params,
            depth=depth, reduced=reduced, direct=direct, indirect=indirect,
            **self._air.medium_bound, **({"skylit": skylit, "shafts": shafts} if sky else {}),
        )  # fmt: skip
