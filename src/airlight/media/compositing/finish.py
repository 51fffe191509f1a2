"""Reduced images of media at full size, transmittance, and attenuated surfaces, in one pass.

It does the same as `upsample`, `transmittance` and `compose` one after the other, where no density
grid needs more: what they read of a pixel is read once, and surfaces are attenuated where they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.fullscreen import FullscreenPass
from ...gpu.memory import Texture, nearest_sampler
from ...gpu.slots import sampler, texture, uniform
from ..gpu_media import GpuMedia
from ..pixel_list import PixelList, RedrawParams, pixel_list_slots
from ..rays import RayParams, Rays

_TARGETS = ("direct", "indirect", "multiple", "transmittance")
_BYTES = 16  # of a pixel of one target
# Two targets hold the surfaces: transmittance multiplies their colours, their alpha stays.
_FEATURE = "float32-blendable"
_KEPT = {"src_factor": "zero", "dst_factor": "one", "operation": "add"}
_TIMES = {"src_factor": "zero", "dst_factor": "src", "operation": "add"}
_ONCE = """
// Single scattering of lights: the weighted sum, and between which colours it lies.
struct Once {
    sum: vec3f,
    least: vec3f,
    most: vec3f,
}
"""
# Parts of the fragment, with and without the sky and shafts.
_SKY = "return reduced_texel(skylit, texel).rgb;"
_SHAFTS = "(*out).single = vec4f(textureLoad(shafts, pixel, 0).rgb + sky, 1.0);"
_ADD_SHAFTS = """
    let here = reduced_texel(shafts, texel).rgb;
    (*once).sum += weight * here;
    let is_same = likeness > SAME_DEPTH;
    (*once).least = select((*once).least, min((*once).least, here), is_same);
    (*once).most = select((*once).most, max((*once).most, here), is_same);
"""
_LIST_SHAFTS = """
    (*out).single = vec4f(once.sum / total + sky, 1.0);
    if (is_redrawn(once.least, once.most, redrawn.contrast)) {
        list_pixel(vec2u(pixel), sky, redrawn.group);
    }
"""


def can_finish(gpu: Gpu) -> bool:
    """Whether a pass may have so many targets, and multiply what is in them: one that draws may.

    Where full-screen passes compute instead, one for each of its parts is quicker.
    """
    if gpu.paths.stored_screens:
        return False
    most = gpu.limits["max-color-attachment-bytes-per-sample"]
    return most >= _BYTES * (len(_TARGETS) + 1) and _FEATURE in gpu.features


@dataclass(frozen=True, eq=False)
class Reduced:
    """What is upsampled: multiple scattering, and single scattering of the sky.

    `shafts`: single scattering of lights, reduced where pixels are listed, else of full size.
    """

    multiple: Texture
    shafts: Texture
    skylit: Texture | None = None


@dataclass(frozen=True, eq=False)
class MediaLayers:
    """The layers of an image: `surfaces` (direct, indirect), which are attenuated, and of media."""

    surfaces: tuple[Texture, Texture]
    multiple: Texture
    transmittance: Texture
    single: Texture


@dataclass(frozen=True, eq=False)
class Listing:
    """The list of pixels to be redrawn, and the contrast from which on they are."""

    pixels: PixelList
    params: RedrawParams


class Finish(FullscreenPass):
    """Reduced images of media -> the attenuated layers of surfaces, and those of media.

    The alpha of reduced images is the distance of each ray, m. `has_sky`: single scattering of the
    sky is a reduced image, too, added to the shafts. `lists`: shafts are reduced, too, and pixels
    that cannot be interpolated between their texels are listed, to be redrawn.
    """

    vertex_entry = "vertex"
    blend: ClassVar[dict[str, Any]] = {"color": _TIMES, "alpha": _KEPT}
    blended = 2
    file = "finish.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia, *, has_sky: bool, lists: bool = False) -> None:
        # Images that are written, and reduced ones that they come from.
        self._media, self._has_sky, self._has_single = media, has_sky, has_sky or lists
        names = [*_TARGETS, *["single"] * self._has_single]
        self.targets = ("rgba32float",) * len(names)
        read = ["reduced", *["skylit"] * has_sky, *["shafts"] * self._has_single]
        self.slots = (
            uniform("rays", RayParams),
            texture("depth", "2d", "depth"),
            *media.medium_slots,
            *(texture(name, "2d", "unfilterable-float") for name in read),
            sampler("nearest", "non-filtering"),
            *(pixel_list_slots() if lists else ()),
        )
        # A sampler takes the nearest texel in half of the time that CPU adapters take to load it.
        self._nearest = nearest_sampler(gpu)
        super().__init__(
            gpu,
            generated=media.medium_wgsl + self._generated(names, lists=lists),
        )

    def _generated(self, names: list[str], *, lists: bool) -> str:
        """The WGSL that reads and writes single scattering."""
        # Targets as a struct; single scattering comes from the sky, from shafts, both or neither.
        fields = "".join(f"    @location({i}) {n}: vec4f,\n" for i, n in enumerate(names))
        sky = _SKY if self._has_sky else "return vec3f(0.0);"
        shafts = _SHAFTS if self._has_sky else ""
        return (
            f"{'//! use pixel_list' if lists else ''}\n"
            f"struct Finished {{\n{fields}}}\n{_ONCE}"
            f"const IS_ONE_BOX = {str(self._media.is_one_box).lower()};\n"
            f"fn skylit_at(texel: vec2f) -> vec3f {{ {sky} }}\n"
            "fn add_once(once: ptr<function, Once>, texel: vec2f, likeness: f32, weight: f32) {"
            f"{_ADD_SHAFTS if lists else ''}}}\n"
            "fn set_single(out: ptr<function, Finished>, pixel: vec2i, once: Once, total: f32,"
            f" sky: vec3f) {{{_LIST_SHAFTS if lists else shafts}}}\n"
        )

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        depth: Texture,
        reduced: Reduced,
        layers: MediaLayers,
        listing: Listing | None = None,
    ) -> None:
        """Attenuate the surfaces of `layers`, fill the others from `reduced` images.

        The single scattering is filled where there is a sky or a `listing`.
        """
        # What is read of single scattering, and the list of pixels that cannot be interpolated.
        read = {"skylit": reduced.skylit} if self._has_sky else {}
        read |= {"shafts": reduced.shafts} if self._has_single else {}
        bound = {}
        if listing is not None:
            listing.pixels.begin(commands)
            bound = {"redrawn": listing.params, **listing.pixels.bound}
        single = [layers.single] * self._has_single
        self.draw(
            commands,
            (*layers.surfaces, layers.multiple, layers.transmittance, *single),
            rays=rays.params,
            depth=depth,
            reduced=reduced.multiple,
            nearest=self._nearest,
            **self._media.medium_bound,
            **read,
            **bound,
        )
