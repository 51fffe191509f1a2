"""The passes of mirrored rays, and what they are given."""

from __future__ import annotations

from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f, u32, vec2f, vec2u, vec3f
from ..gpu.slots import Slot, image, storage, texture, uniform
from ..rays.rays import RAY_SLOTS
from .albedo import AlbedoData
from .glosses import GlossData

# How a texel's ray ended: none was sent, it left the scene, it met a surface.
KINDS = "const NOWHERE = 0.0;\nconst LEFT = 1.0;\nconst MET = 2.0;\n"
_NO_AIR = "fn air_of(row: u32) -> Air { return Air(vec3f(0.0), vec3f(1.0)); }\n"
_AIR = "fn air_of(row: u32) -> Air { return Air(air[row].rgb, air[row + 1u].rgb); }\n"


class MirrorParams(Struct):
    """The camera, and which rows of the list are followed."""

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    first = u32("row of the list")
    size = vec2f("px")
    batch = vec2u("texels")
    sample = u32("of the still")
    reach = f32("px, within which pixels share rays")
    texel = f32("m, how wide a pixel is one metre away")
    segment = u32("of the paths; 0 starts at pixels")
    raised = f32("m, how far above surfaces later segments start")
    goes_on = u32("whether metals that are met send another segment")
    pad = vec2u()


# Of the view's pixels, then of what rays met.
_PIXELS: tuple[Slot, ...] = (
    uniform("params", MirrorParams),
    texture("depth", "2d", "depth"),
    texture("albedo", "2d", "unfilterable-float"),
    texture("normal", "2d", "unfilterable-float"),
    texture("emission", "2d", "unfilterable-float"),
)
_FOUND: tuple[Slot, ...] = tuple(
    texture(name, "2d", "unfilterable-float")
    for name in ("hit_positions", "hit_normals", "hit_albedos")
)


class Listing(ComputePass):
    """Lists the pixels that send rays, and notes whose ray each pixel shows."""

    slots = (
        *_PIXELS,
        storage("found", "atomic<u32>", "read_write"),
        storage("listed", "u32", "read_write"),
        image("senders", "r32uint"),
    )
    file = "mirror_list.wgsl"


class Counting(ComputePass):
    """Counts the rays of a segment, and writes the arguments of the passes over them."""

    slots = (
        uniform("params", MirrorParams),
        storage("found", "atomic<u32>", "read_write"),
        storage("arguments", "u32", "read_write"),
    )
    workgroup = (1, 1, 1)
    file = "mirror_counts.wgsl"


class FirstRays(ComputePass):
    """Sends a ray from each listed pixel."""

    slots = (
        *(slot for slot in _PIXELS if slot.name not in ("albedo", "emission")),
        *RAY_SLOTS,
        storage("albedo_rows", AlbedoData),
        storage("albedo_texels", "u32"),
        storage("found", "u32"),
        storage("listed", "u32"),
        storage("next_pixels", "u32", "read_write"),
        image("next_starts", "rgba32float"),
        image("hit_positions", "rgba32float"),
        image("hit_normals", "rgba16float"),
        image("hit_albedos", "rgba16float"),
    )
    file = "mirror_rays.wgsl"


class LaterRays(ComputePass):
    """Sends a ray from each metal that a mirrored ray has met."""

    slots = (
        uniform("params", MirrorParams),
        texture("starts", "2d", "unfilterable-float"),
        texture("met_positions", "2d", "unfilterable-float"),
        texture("met_normals", "2d", "unfilterable-float"),
        *RAY_SLOTS,
        storage("albedo_rows", AlbedoData),
        storage("albedo_texels", "u32"),
        storage("glosses", GlossData),
        storage("found", "atomic<u32>", "read_write"),
        storage("pixels", "u32"),
        storage("next_pixels", "u32", "read_write"),
        image("next_starts", "rgba32float"),
        image("hit_positions", "rgba32float"),
        image("hit_normals", "rgba16float"),
        image("hit_albedos", "rgba16float"),
    )
    file = "mirror_bounce.wgsl"


class MirrorLight(ComputePass):
    """Adds up what rays found, with its light."""

    file = "mirror_light.wgsl"

    def __init__(self, gpu: Gpu, *, has_air: bool) -> None:
        self.slots = (
            uniform("params", MirrorParams),
            texture("starts", "2d", "unfilterable-float"),
            *_FOUND,
            texture("lit", "2d", "unfilterable-float"),
            texture("direct_light", "2d", "unfilterable-float"),
            texture("indirect_light", "2d", "unfilterable-float"),
            storage("found", "u32"),
            *((storage("air", "vec4f"),) if has_air else ()),
            storage("glosses", GlossData),
            storage("cosines", "vec4f"),
            storage("pixels", "u32"),
            storage("throughputs", "vec4f", "read_write"),
            image("mirrored_ends", "rgba32float"),
            image("mirrored_found", "rgba32float"),
        )
        super().__init__(gpu, generated=KINDS + (_AIR if has_air else _NO_AIR))


class Resolving(ComputePass):
    """Shares what rays found between pixels."""

    slots = (
        *_PIXELS,
        texture("senders", "2d", "uint"),
        texture("mirrored_ends", "2d", "unfilterable-float"),
        texture("mirrored_found", "2d", "unfilterable-float"),
        storage("cosines", "vec4f"),
        image("mirrored_sky", "rgba32float"),
        image("mirrored_light", "rgba32float"),
    )
    in_bands = True
    file = "mirrors.wgsl"
