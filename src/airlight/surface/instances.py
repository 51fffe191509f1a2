"""Instances of meshes on the device: their transforms and materials, as shaders read them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..gpu.layout import Struct, f32, mat4x4f, u32
from ..maths.transforms import normal_matrix
from ..scene.mesh import Mesh, world_boxes


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
    packed = np.zeros(max(1, len(meshes)), InstanceData.dtype)
    if not meshes:
        return packed

    # Transforms of this frame and of creation, which tell what never moved.
    placed = np.stack([mesh.world_from_object for mesh in meshes])
    before = np.stack([mesh.world_from_object for mesh in first])
    # Matrices are stored column by column.
    packed["world_from_object"] = placed.swapaxes(1, 2)
    packed["normal_from_object"] = normal_matrix(placed).swapaxes(1, 2)
    packed["material"] = materials

    # An instance is static where vertices and transform are those of creation.
    is_same = [mesh.geometry is other.geometry for mesh, other in zip(meshes, first, strict=True)]
    is_still = np.array(is_same) & (placed == before).all(axis=(1, 2))
    sizes = np.ptp(world_boxes(meshes), axis=1).max(axis=1)
    packed["size"] = np.where(is_still, -sizes, sizes)
    return packed
