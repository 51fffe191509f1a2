"""A point sampling of all surfaces, for what lattices must know of geometry.

Kaplanyan2010 section 3.2 samples the camera's and the lights' views, and mentions a precomputed
point sampling (Ritschel2008) as an alternative; that is what we do: a surface blocks light
whether or not any view sees it. Surfels live in object space and move with their instances.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..gpu.layout import Struct, u32, vec3f
from ..maths.colour import srgb_decode
from ..scene.material import Material, Texture
from ..scene.mesh import Mesh

F64 = NDArray[np.float64]


class SurfelData(Struct):
    """A piece of surface in its object's space."""

    position = vec3f("m, object space")
    instance = u32("index into instances")
    area_normal = vec3f("m^2, object space")
    is_two_sided = u32()
    reflectance = vec3f("linear base colour")
    pad = u32()


def surfels(meshes: tuple[Mesh, ...], order: list[int], count: int) -> NDArray[np.void]:
    """About `count` surfels over all `meshes`, by world area; at least one a mesh.

    `order` says at which instance index each mesh stands: order[instance] = mesh. Returns an
    array of `SurfelData`. Cut-out materials contribute the share of the area that is there.
    """
    areas = np.array([_triangle_areas(m).sum() for m in meshes])
    total = max(float(areas.sum()), 1e-30)
    parts = []
    for instance, index in enumerate(order):
        share = max(1, round(count * float(areas[index]) / total))
        parts.append(_mesh_surfels(meshes[index], instance, share))
    return np.concatenate(parts) if parts else np.zeros(1, SurfelData.dtype)


def _triangle_areas(mesh: Mesh) -> F64:
    linear = mesh.world_from_object[:3, :3]
    a, b, c = (mesh.geometry.positions[mesh.geometry.indices[:, k]] @ linear.T for k in range(3))
    return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))


def _mesh_surfels(mesh: Mesh, instance: int, count: int) -> NDArray[np.void]:
    areas = _triangle_areas(mesh)
    made = np.zeros(count, SurfelData.dtype)
    made["instance"] = instance
    if areas.sum() <= 0.0:
        return made
    # Stratified along the running area; the place inside a triangle from a plastic sequence.
    edges = np.cumsum(areas)
    strata = (np.arange(count) + 0.5) / count * edges[-1]
    triangle = np.minimum(np.searchsorted(edges, strata), len(areas) - 1)
    u, v = _triangle_points(count)
    geometry = mesh.geometry
    corners = geometry.indices[triangle]
    a, b, c = (geometry.positions[corners[:, k]].astype(np.float64) for k in range(3))
    weights = np.stack([1.0 - u - v, u, v], axis=1)
    made["position"] = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    # A surfel stands for an equal share of the world area; its object-space area follows.
    world_area = edges[-1] / count
    stretch = areas[triangle][:, None] / np.maximum(0.5 * length, 1e-30)
    area_normal = normal / np.maximum(length, 1e-30) * world_area / np.maximum(stretch, 1e-30)
    colour, cover = _colour_and_cover(mesh.material, geometry.uvs, corners, weights)
    made["area_normal"] = area_normal * cover[:, None]
    made["reflectance"] = colour
    made["is_two_sided"] = int(mesh.material.two_sided)
    return made


def _triangle_points(count: int) -> tuple[F64, F64]:
    """`count` barycentric pairs (u, v), evenly spread (Roberts' R2 sequence, folded)."""
    index = np.arange(count)
    u = (0.5 + 0.7548776662466927 * index) % 1.0
    v = (0.5 + 0.5698402909980532 * index) % 1.0
    fold = u + v > 1.0
    return np.where(fold, 1.0 - u, u), np.where(fold, 1.0 - v, v)


def _colour_and_cover(
    material: Material, uvs: NDArray[np.float32] | None, corners: NDArray[np.uint32], weights: F64
) -> tuple[F64, F64]:
    """Base colour (n, 3), linear, and the share (n,) of each surfel that is not cut away."""
    count = len(weights)
    colour = np.tile(np.asarray(material.base_color), (count, 1))
    cover = np.ones(count)
    texture = material.base_color_texture
    if texture is None or uvs is None:
        return colour, cover
    uv = np.einsum("nk,nkc->nc", weights, uvs[corners].astype(np.float64))
    texel = _texels(texture, uv)
    rgb = texel[:, :3].astype(np.float64) / 255.0
    if texture.is_srgb:
        rgb = srgb_decode(rgb)
    if material.alpha_cutoff > 0.0:
        cover = (texel[:, 3] / 255.0 * material.alpha >= material.alpha_cutoff).astype(np.float64)
    return colour * rgb, cover


def _texels(texture: Texture, uv: F64) -> NDArray[np.uint8]:
    height, width = texture.pixels.shape[:2]
    place = (uv * texture.scale + texture.offset) % 1.0
    x = np.minimum((place[:, 0] * width).astype(int), width - 1)
    y = np.minimum((place[:, 1] * height).astype(int), height - 1)
    return np.asarray(texture.pixels[y, x])
