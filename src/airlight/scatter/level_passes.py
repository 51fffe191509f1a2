"""What goes between a lattice and the next coarser one: residuals down, corrections up."""

from __future__ import annotations

from ..gpu.compute import ComputePass
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..gpu.slots import storage, uniform


class LevelParams(Struct):
    """Two lattices, one half as fine as the other."""

    fine = vec3u("cells")
    cell = f32("m, of the finer")
    coarse = vec3u("cells")
    flags = u32("1: there are walls; 2: the medium varies")
    track = vec3f("m, of isotropic light per hop, by channel, in a homogeneous medium")


_PAIR = uniform("params", LevelParams)


class Restrict(ComputePass):
    """What is still missing of the sum, on the coarser lattice."""

    slots = (
        _PAIR,
        storage("stepped", "vec4f"),
        storage("sum", "vec4f"),
        storage("residual", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "level_restrict.wgsl"


class Prolong(ComputePass):
    """The coarser lattice's correction, on the finer one."""

    slots = (
        _PAIR,
        storage("track", "vec4f"),
        storage("medium", "vec2f"),
        storage("face_visibility", "vec2u"),
        storage("sum", "vec4f"),
        storage("change", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "level_prolong.wgsl"


class RestrictMedium(ComputePass):
    """The medium of eight cells, as one cell has it."""

    slots = (_PAIR, storage("medium", "vec2f"), storage("coarse_medium", "vec2f", "read_write"))
    workgroup = (32, 4, 2)
    file = "level_medium.wgsl"


class RestrictFaces(ComputePass):
    """How open and how reflecting the faces of eight cells are, as one cell has it."""

    slots = (
        _PAIR,
        storage("face_visibility", "vec2u"),
        storage("reflectance", "u32"),
        storage("coarse_face_visibility", "vec2u", "read_write"),
        storage("coarse_reflectance", "u32", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "level_faces.wgsl"
