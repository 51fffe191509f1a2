"""A point sampling of all surfaces, from which blockers are made.

Kaplanyan2010 section 3.2 samples the camera's and the lights' views, and mentions a precomputed
point sampling (Ritschel2008) as an alternative. Surfels are that alternative: a surface blocks
light whether or not a view sees it. They live in object space and move with their instances.
"""

from __future__ import annotations

from collections.abc import Sequence, Set

import numpy as np
from numpy.typing import NDArray

from ..gpu.layout import Struct, u32, vec3f
from ..maths.arrays import F32, F64, I64
from ..maths.chunks import chunks
from ..maths.colour import srgb_decode
from ..maths.reflection import bihemispherical_albedo
from ..scene.light_shapes import LightMesh
from ..scene.material import Material, Texture
from ..scene.mesh import Geometry, Mesh
from ..scene.texels import in_image, interpolated, nearest
from ..surface.materials import chance_to_meet, reflecting_share
from .rooms import Rooms

_LIGHTS = 0.125
"""Of the surfels of all other surfaces: what the surfaces of all area lights have together."""


class SurfelData(Struct):
    """A piece of surface in its object's space."""

    position = vec3f("m, object space")
    instance = u32("index into instances")
    area_normal = vec3f("m^2, object space")
    is_two_sided = u32()
    reflectance = vec3f("bihemispherical albedo, linear")
    is_sealing = u32("1: of the opaque wall of a room, see `sealed`")


def surfels(
    meshes: tuple[Mesh, ...], order: list[int], count: int, sides: Sequence[int] | None = None
) -> NDArray[np.void]:
    """About `count` surfels over all `meshes`, by world area; at least one per mesh.

    `order` says at which instance index each mesh stands: order[instance] = mesh. Returns an array
    of `SurfelData`. Cut-out materials contribute the share of the area that is not cut away,
    translucent ones that of the light that does not pass them.
    `sides`: which side of each mesh blocks, as Rooms.sides; by default those without any room.
    """
    sides = Rooms(meshes, np.zeros((0, 3))).sides if sides is None else sides
    # World areas, which instances share.
    areas_of: dict[tuple[int, bytes], F64] = {}
    for mesh in meshes:
        if _area_key(mesh) not in areas_of:
            areas_of[_area_key(mesh)] = triangle_areas(mesh)
    areas = np.array([areas_of[_area_key(m)].sum() for m in meshes])

    # The number follows from the world's area, so that density is the same on all meshes.
    counts = _counts(meshes, areas, count)
    parts = []
    for instance, index in enumerate(order):
        mesh = meshes[index]
        own = areas_of[_area_key(mesh)]
        parts.append(_mesh_surfels(mesh, own, instance, counts[index], sides[index]))
    return np.concatenate(parts) if parts else np.zeros(1, SurfelData.dtype)


def _counts(meshes: tuple[Mesh, ...], areas: F64, count: int) -> list[int]:
    """How many surfels each mesh has: by its share of all area; lights' surfaces as many each.

    Those grow and shrink, and no other surface's number follows from how large they were at first.
    """
    # Area lights change their size, and take no share of others' surfels.
    is_light = np.array([isinstance(mesh, LightMesh) for mesh in meshes], bool)
    total = max(float(areas[~is_light].sum()), 1e-30)
    each = count * _LIGHTS / max(int(is_light.sum()), 1)
    wanted = np.where(is_light, each, count * areas / total)
    return [max(1, round(float(number))) for number in wanted]


def triangle_areas(mesh: Mesh) -> F64:
    """Area (T,), m^2, of each triangle in the world."""
    # In the world, where a transform has stretched them.
    linear = mesh.world_from_object[:3, :3]
    positions, indices = mesh.geometry.positions, mesh.geometry.indices
    areas = np.empty(len(indices))
    for part in chunks(len(indices)):
        a, b, c = (positions[indices[part, k]] @ linear.T for k in range(3))
        areas[part] = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return areas


def _area_key(mesh: Mesh) -> tuple[int, bytes]:
    """What `triangle_areas` depends on: many instances share theirs."""
    return id(mesh.geometry), mesh.world_from_object[:3, :3].tobytes()


def _mesh_surfels(mesh: Mesh, areas: F64, instance: int, count: int, side: int) -> NDArray[np.void]:
    made = np.zeros(count, SurfelData.dtype)
    made["instance"] = instance
    if areas.sum() <= 0.0:
        return made
    # The samples follow from areas and their number alone: `follow` finds the same ones again.
    triangle, weights = samples_of(areas, count)
    geometry = mesh.geometry

    # The point in its triangle, and the triangle's normal.
    corners = geometry.indices[triangle]
    a, b, c = _corners(geometry, triangle)
    u, v = weights[:, 1], weights[:, 2]
    made["position"] = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    # A surfel stands for an equal share of the world area; its object-space area follows.
    world_area = areas.cumsum()[-1] / count
    stretch = areas[triangle][:, None] / np.maximum(0.5 * length, 1e-30)
    area_normal = normal / np.maximum(length, 1e-30) * world_area / np.maximum(stretch, 1e-30)
    albedo, cover = _albedo_and_cover(mesh.material, geometry.uvs, corners, weights)
    # A closed body stops light with its outside; both sides of it would count every body twice.
    made["area_normal"] = area_normal * (cover * (side or 1))[:, None]
    made["reflectance"] = albedo
    made["is_two_sided"] = int(side == 0 and mesh.material.two_sided)
    return made


def turned(
    made: NDArray[np.void],
    order: list[int],
    meshes: tuple[Mesh, ...],
    before: Sequence[int],
    now: Sequence[int],
) -> NDArray[np.void]:
    """The surfels `made` for some sides that block, as they are for others: Rooms.sides."""
    found = made.copy()
    for instance, index in enumerate(order):
        if before[index] != now[index]:
            rows = made["instance"] == instance
            # 0, both sides, has the normals of the front: a turn is the product of signs.
            found["area_normal"][rows] *= (before[index] or 1) * (now[index] or 1)
            is_both = now[index] == 0 and meshes[index].material.two_sided
            found["is_two_sided"][rows] = int(is_both)
    return found


def sealed(
    made: NDArray[np.void], order: list[int], meshes: tuple[Mesh, ...], walls: Set[int]
) -> NDArray[np.void]:
    """The same surfels, marked where they are of opaque `walls` of rooms: Rooms.walls."""
    found = made.copy()

    # Cut-out and translucent materials let some light pass even in a wall.
    is_opaque = [not (m.material.is_translucent or m.material.alpha_cutoff > 0.0) for m in meshes]
    is_wall = [index in walls and is_opaque[index] for index in order]
    found["is_sealing"] = np.array(is_wall, np.uint32)[made["instance"]] if order else 0
    return found


def mean_reflectances(made: NDArray[np.void], instances: int) -> F32:
    """Of each of so many `instances` the reflectance of its surfels, in the mean of channels."""
    rows = made["instance"]
    sums = np.bincount(rows, made["reflectance"].mean(axis=1), minlength=instances)
    counts = np.bincount(rows, minlength=instances)
    return np.asarray(sums / np.maximum(counts, 1), np.float32)


def follow(
    made: NDArray[np.void], order: list[int], original: tuple[Mesh, ...], now: tuple[Mesh, ...]
) -> NDArray[np.void]:
    """The surfels `made` of the `original` meshes, moved with the vertices as they are `now`.

    Each stays at its barycentric coordinates, and its area changes with the triangle's.
    """
    moved = made.copy()
    for instance, index in enumerate(order):
        before, after = original[index].geometry, now[index].geometry
        if before is not after:
            rows = np.flatnonzero(made["instance"] == instance)

            # The very same samples as at creation: they follow from areas and number alone.
            triangle, weights = samples_of(triangle_areas(original[index]), len(rows))
            old, new = _corners(before, triangle), _corners(after, triangle)
            cross = np.cross(new[1] - new[0], new[2] - new[0])
            crossed = np.cross(old[1] - old[0], old[2] - old[0])
            # Of a body that faces in, the side that counts is the triangles' back.
            along = np.einsum("nc,nc->n", made["area_normal"][rows], crossed)
            share = along / np.maximum(np.einsum("nc,nc->n", crossed, crossed), 1e-30)
            moved["position"][rows] = np.einsum("nk,knc->nc", weights, new)
            moved["area_normal"][rows] = cross * share[:, None]
    return moved


def samples_of(areas: F64, count: int) -> tuple[I64, F64]:
    """Triangles (n,) and barycentric weights (n, 3) of `count` surfels over them."""
    # Stratified along the running area; points inside a triangle from the plastic sequence.
    edges = np.cumsum(areas)
    strata = (np.arange(count) + 0.5) / count * edges[-1]
    u, v = _triangle_points(count)
    triangle = np.minimum(np.searchsorted(edges, strata), len(areas) - 1)
    return triangle, np.stack([1.0 - u - v, u, v], axis=1)


def _corners(geometry: Geometry, triangle: I64) -> F64:
    """(3, n, 3): the corners of triangles, metres, object space."""
    return geometry.positions[geometry.indices[triangle].T].astype(np.float64)


def _triangle_points(count: int) -> tuple[F64, F64]:
    """`count` barycentric pairs (u, v), evenly spread (Roberts' R2 sequence, folded)."""
    # Fractions of the plastic number's powers, folded back over the diagonal of the square.
    index = np.arange(count)
    u = (0.5 + 0.7548776662466927 * index) % 1.0
    v = (0.5 + 0.5698402909980532 * index) % 1.0
    fold = u + v > 1.0
    return np.where(fold, 1.0 - u, u), np.where(fold, 1.0 - v, v)


def _albedo_and_cover(
    material: Material, uvs: F32 | None, corners: NDArray[np.uint32], weights: F64
) -> tuple[F64, F64]:
    """Bihemispherical albedo (n, 3) and the share (n,) of each surfel that is not cut away."""
    # The BRDF's albedo at the surfel's own texture coordinates.
    uv = None if uvs is None else np.einsum("nk,nkc->nc", weights, uvs[corners].astype(np.float64))
    colour, cover = _colour_and_cover(material, uv, len(weights))
    metallic, roughness = _metallic_and_roughness(material, uv, len(weights))
    specular = np.full(len(weights), material.specular)
    return bihemispherical_albedo(colour, metallic, roughness, specular), cover


def _colour_and_cover(material: Material, uv: F64 | None, count: int) -> tuple[F64, F64]:
    """Base colour (n, 3), linear, and the share (n,) of each surfel that light meets."""
    # The material's own, times its texture; cut away where alpha is below the cutoff.
    colour = np.tile(np.asarray(material.base_color), (count, 1)) * reflecting_share(material)
    cover = np.full(count, chance_to_meet(material) if material.is_translucent else 1.0)
    texture = material.base_color_texture
    if texture is None or uv is None:
        return colour, cover
    texel = nearest(texture, uv)
    rgb = texel[:, :3].astype(np.float64) / 255.0
    if texture.is_srgb:
        rgb = srgb_decode(rgb)
    # Cut out, a texel blocks or does not; blended, it blocks by its share.
    if material.alpha_cutoff > 0.0:
        alpha = _filtered_alpha(texture, uv) * material.alpha
        cover *= alpha >= material.alpha_cutoff
    elif material.is_blended:
        cover *= _filtered_alpha(texture, uv)
    return colour * rgb, cover


def _metallic_and_roughness(material: Material, uv: F64 | None, count: int) -> tuple[F64, F64]:
    """(n,) each, 0 to 1."""
    metallic, roughness = np.full(count, material.metallic), np.full(count, material.roughness)
    texture = material.metallic_roughness_texture
    if texture is None or uv is None:
        return metallic, roughness
    # Green is roughness, and blue is metallic, as in glTF.
    texel = nearest(texture, uv).astype(np.float64) / 255.0
    return metallic * texel[:, 2], roughness * texel[:, 1]


def _filtered_alpha(texture: Texture, uv: F64) -> F64:
    """Alpha (n,), 0..1, between texels as the surface passes read it before they cut it."""
    alpha = interpolated(texture.pixels[..., 3:], in_image(texture, uv), texture.wrap)
    return alpha[:, 0] / 255.0
