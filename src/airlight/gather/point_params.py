"""What passes over gather points, or from them to pixels, must know and bind."""

from __future__ import annotations

from ..gpu.layout import Struct, f32, mat4x4f, u32, vec2f, vec2u, vec3f
from ..gpu.slots import image, texture, uniform


class PointParams(Struct):
    """The camera, and how the image is reduced."""

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    scale = u32("pixels along a side of a texel")
    size = vec2f("px")
    reduced = vec2u("texels, one for each block of pixels")
    sample = u32("of the still")
    texel = f32("m, how wide a texel is one metre away")
    rays = u32("of a point")
    step = u32("pixels of a block from one that is tried to the next")
    most = u32("orphan points of the image")
    pad = u32()


CHOOSING_SLOTS = (
    uniform("params", PointParams),
    texture("depth", "2d", "depth"),
    texture("normal", "2d", "unfilterable-float"),
    texture("near_field", "2d", "uint"),
    image("places", "rgba32float"),
    image("starts", "rgba32float"),
    image("normals", "rgba16float"),
    image("planes", "rgba16float"),
)
"""Of passes that make points of pixels (`wgsl/gather_point.wgsl`)."""
