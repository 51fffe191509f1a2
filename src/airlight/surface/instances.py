"""Instances of meshes on the device: their transforms and materials, as shaders read them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.layout import Struct, f32, mat4x4f, pack_array, u32
from ..scene.mesh import Mesh

F64 = NDArray[np.float64]


class InstanceData(Struct):
    """The transform and the material of one instance of a geometry."""

    world_from_object = mat4x4f()
    normal_from_object = mat4x4f()
    material = u32("index into materials")
    size = f32("m, longest side of its box; negative where it never moved")


def packed_instances(
    meshes: Sequence[Mesh], first: Sequence[Mesh], materials: Sequence[int]
) -> NDArray[np.void]:
    """`InstanceData` of meshes that stood as `first` at creation; `materials`: their rows."""
    rows: list[dict[str, Any]] = [
        {
            "world_from_object": mesh.world_from_object,
            "normal_from_object": normal_matrix(mesh.world_from_object),
            "material": material,
            "size": _size(mesh, before),
        }
        for mesh, before, material in zip(meshes, first, materials, strict=True)
    ]
    return pack_array(InstanceData, rows)


def is_mirrored(mesh: Mesh) -> bool:
    """Whether the mesh's transform turns counter-clockwise triangles clockwise."""
    return bool(np.linalg.det(mesh.world_from_object[:3, :3]) < 0.0)


def normal_matrix(world_from_object: F64) -> F64:
    """The inverse transpose, which keeps normals perpendicular under non-uniform scale."""
    linear = world_from_object[:3, :3]
    normal = np.eye(4)
    # The cofactor matrix is det * inverse transpose and exists for flat transforms too.
    a, b, c = linear.T
    normal[:3, :3] = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    if np.linalg.det(linear) < 0.0:
        normal[:3, :3] *= -1.0
    return normal


def _size(mesh: Mesh, first: Mesh) -> float:
    """`InstanceData.size` of a mesh that stood as `first` does."""
    low, high = mesh.world_bounds
    is_still = mesh.geometry is first.geometry and np.array_equal(
        mesh.world_from_object, first.world_from_object
    )
    size = float(np.max(high - low))
    return -size if is_still else size
