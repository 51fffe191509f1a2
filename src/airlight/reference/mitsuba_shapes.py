"""airlight meshes as Mitsuba shapes: a PLY for each geometry, placed as the scene places it.

What is emissive and what is mirrored is written in world space: an area emitter's back side lies a
length in metres behind its front, and Mitsuba takes a mirrored triangle's back for its front.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from ..scene.checks import F32, F64, Rgb
from ..scene.material import Material, Texture
from ..scene.mesh import Geometry, Mesh, in_world
from .mitsuba_files import FileStore, write_exr, write_ply
from .mitsuba_material import is_absent, is_masked, material_reference
from .mitsuba_textures import add_bitmap, linear_pixels
from .mitsuba_xml import add_matrix, add_reference, add_rgb, add_text, add_truth, plugin

BACK_OFFSET = 1e-5  # of the scene's diagonal: the gap between the two sides of an emissive sheet
EMISSION_LEVELS = 24  # colours a texture's glow is reduced to where Mitsuba cannot map it


@dataclass(frozen=True)
class _Part:
    """Triangles that glow alike: their mask, and the radiance or its texture."""

    triangles: NDArray[np.bool_]
    radiance: Rgb = (0.0, 0.0, 0.0)
    texture: Texture | None = None

    @property
    def glows(self) -> bool:
        return max(self.radiance) > 0.0


def mesh_shapes(mesh: Mesh, diagonal: float, files: FileStore, notes: list[str]) -> list[Element]:
    """The shapes of one placed mesh; none where its alpha cutoff removes all of it."""
    material = mesh.material
    if is_absent(material):
        return []
    # What glows is split and offset in metres of the world, and a mirrored placement would turn
    # normals about: both are written as they are placed.
    is_placed = not np.array_equal(mesh.world_from_object, np.eye(4))
    is_flat = np.linalg.det(mesh.world_from_object[:3, :3]) <= 0.0
    is_baked = is_placed and (material.is_emissive or is_flat)
    geometry = in_world(mesh) if is_baked else mesh.geometry
    if material.is_emissive and is_masked(material, geometry):
        notes.append(f"material '{material.name}': the parts cut away by its alpha still glow")
    shapes = []
    # A shape has one emitter, hence one for each part; a two-sided one glows by a flipped copy just
    # behind.
    for part in _emission_parts(material, geometry, notes):
        kept = geometry
        if not part.triangles.all():
            kept = replace(geometry, indices=geometry.indices[part.triangles])
        has_back = part.glows and material.two_sided
        side = "_front" if has_back else ""
        shapes.append(_shape(mesh, kept, part, files, notes, side))
        if is_placed and not is_baked:
            add_matrix(shapes[-1], "to_world", mesh.world_from_object)
        if has_back:
            back = _flipped(kept, BACK_OFFSET * diagonal)
            shapes.append(_shape(mesh, back, part, files, notes, "_back"))
    return shapes


def _flipped(geometry: Geometry, offset: float) -> Geometry:
    """The other side of a sheet, a hair behind it."""
    assert geometry.normals is not None
    return replace(
        geometry,
        positions=geometry.positions - np.float32(offset) * geometry.normals,
        normals=-geometry.normals,
        indices=np.ascontiguousarray(geometry.indices[:, ::-1]),
    )


def _shape(
    mesh: Mesh, geometry: Geometry, part: _Part, files: FileStore, notes: list[str], side: str
) -> Element:
    # scene/io/mitsuba.py takes a front and a back for one two-sided sheet again.
    shape = plugin("shape", "ply", id=f"mesh_{len(files.meshes)}{side}")
    files.meshes.append(mesh.name)
    add_text(shape, "filename", _ply(mesh.material, geometry, files))
    if part.glows and _is_smooth(geometry):
        # An area emitter decides by the shading normal which side glows; only the flat one
        # is right.
        add_truth(shape, "face_normals", True)
        if max(mesh.material.base_color) > 0.0:
            notes.append(f"mesh '{mesh.name}': glowing, so it is shaded flat in Mitsuba")
    if part.glows:
        shape.append(_area_emitter(part, files))
    add_reference(shape, material_reference(mesh.material, geometry, files, notes))
    return shape


def _ply(material: Material, geometry: Geometry, files: FileStore) -> str:
    # Mitsuba does not multiply vertex colours with a base colour, so they are stored multiplied.
    colors = None
    if geometry.colors is not None:
        colors = np.clip(geometry.colors[:, :3], 0.0, 1.0)
        colors = colors * np.array(material.base_color, np.float32)
    tint = material.base_color if colors is not None else None
    key = ("ply", files.identity(geometry.indices), files.identity(geometry.positions), tint)
    return files.once(
        key,
        "mesh",
        "ply",
        lambda path: write_ply(
            path,
            geometry.positions,
            geometry.indices,
            normals=geometry.normals,
            uvs=geometry.uvs,
            colors=colors,
        ),
    )


def _is_smooth(geometry: Geometry) -> bool:
    """Whether vertex normals differ by over a degree from the triangles' own."""
    # Cosines between each triangle's normal and those of its three vertices.
    assert geometry.normals is not None
    a, b, c = (geometry.positions[geometry.indices[:, k]].astype(np.float64) for k in range(3))
    face = np.cross(b - a, c - a)
    length = np.linalg.norm(face, axis=1)
    face = face[length > 0.0] / length[length > 0.0, None]
    cosines = [
        np.einsum("ij,ij->i", face, geometry.normals[geometry.indices[length > 0.0, k]])
        for k in range(3)
    ]
    return bool(np.min(cosines, initial=1.0) < np.cos(np.radians(1.0)))


def _area_emitter(part: _Part, files: FileStore) -> Element:
    emitter = plugin("emitter", "area")
    if part.texture is None:
        add_rgb(emitter, "radiance", part.radiance)
        return emitter
    # Emission is written linear and in absolute units, as EXR, because bitmaps of 8 bits end at 1.
    texture, radiance = part.texture, part.radiance
    key = (files.identity(texture.pixels), "emission", texture.is_srgb, radiance)
    filename = files.once(
        key,
        "emission",
        "exr",
        lambda path: write_exr(path, linear_pixels(texture) * np.array(radiance, np.float32)),
    )
    add_bitmap(emitter, "radiance", texture, filename, raw=True)
    return emitter


def _emission_parts(material: Material, geometry: Geometry, notes: list[str]) -> list[_Part]:
    """The mesh split by what glows. Most meshes are one part."""
    # A texture on an emitter is sampled by uv, which needs each texel to be on one place of the
    # surface.
    everything = np.ones(len(geometry.indices), dtype=bool)
    texture = material.emission_texture
    if not material.is_emissive or texture is None or geometry.uvs is None:
        return [_Part(everything, material.emission)]
    if _maps_uniquely(texture, geometry):
        return [_Part(everything, material.emission, texture)]
    notes.append(
        f"material '{material.name}': its emission texture repeats or overlaps, each triangle "
        "glows in its mean colour"
    )
    # Otherwise each triangle glows in its mean; similar ones share a shape, as thousands would be
    # slow.
    means = _triangle_means(texture, geometry) * np.array(material.emission)
    top = float(means.max())
    if top <= 0.0:
        return [_Part(everything)]
    levels = np.round(means / top * EMISSION_LEVELS).astype(np.int64)
    groups, member = np.unique(levels, axis=0, return_inverse=True)
    parts = []
    for group in range(len(groups)):
        inside = member.ravel() == group
        mean = means[inside].mean(axis=0)
        radiance = (float(mean[0]), float(mean[1]), float(mean[2]))
        parts.append(_Part(inside, radiance if groups[group].max() > 0 else (0.0, 0.0, 0.0)))
    return parts


def _maps_uniquely(texture: Texture, geometry: Geometry) -> bool:
    """Whether no texel is used twice: Mitsuba samples a glowing texture by its texels."""
    # Coordinates that are transformed or leave the unit square use texels twice or not at all.
    if texture.scale != (1.0, 1.0) or texture.offset != (0.0, 0.0):
        return False
    assert geometry.uvs is not None
    uv = geometry.uvs[geometry.indices].astype(np.float64)
    if uv.min() < -1e-6 or uv.max() > 1.0 + 1e-6:
        return False
    return _covered_share(uv) >= 0.97


def _covered_share(uv: F64) -> float:
    """Area of the union of uv triangles (T, 3, 2) over the sum of their areas, on samples.

    Points spread evenly over the triangles fall into cells of a grid; overlapping triangles
    fill fewer cells than their areas add up to.
    """
    # Areas in texture space; more than the unit square cannot be free of overlaps.
    side = 64
    edge = uv[:, 1:] - uv[:, :1]
    area = 0.5 * np.abs(edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0])
    total = float(area.sum())
    if total <= 0.0:
        return 0.0
    if total > 1.0 + 1e-6:
        return 0.0

    # Points spread over the triangles by area, and counted by cell.
    rng = np.random.default_rng(0)
    count = 32 * side * side
    chosen = np.searchsorted(np.cumsum(area) / total, rng.random(count)).clip(0, len(uv) - 1)
    s, t = np.sqrt(rng.random(count)), rng.random(count)
    weights = np.stack([1 - s, s * (1 - t), s * t], axis=1)
    points = np.einsum("ij,ijk->ik", weights, uv[chosen])
    cells = np.minimum((points * side).astype(np.int64), side - 1)
    hits = np.bincount(cells[:, 1] * side + cells[:, 0], minlength=side * side)
    # Where nothing overlaps, no cell gets more than its own area's share of the points.
    allowed = count / (total * side * side)
    excess = np.maximum(hits - allowed - 6.0 * np.sqrt(allowed), 0.0).sum()
    return 1.0 - float(excess) / count


def _triangle_means(texture: Texture, geometry: Geometry) -> F64:
    """Mean linear colour (T, 3) over each triangle, from 36 points."""
    # Centroids of the 36 upright triangles that cutting each side into 8 makes.
    assert geometry.uvs is not None
    pixels = linear_pixels(texture)
    uv = geometry.uvs[geometry.indices] * np.array(texture.scale) + np.array(texture.offset)
    grid = np.array([(i, j) for i in range(8) for j in range(8 - i)], dtype=np.float64)
    total = np.zeros((len(uv), 3))
    for i, j in grid:
        b, c = (i + 1 / 3) / 8, (j + 1 / 3) / 8
        at = uv[:, 0] * (1 - b - c) + uv[:, 1] * b + uv[:, 2] * c
        total += _nearest(pixels, at, texture.wrap)
    return total / len(grid)


def _nearest(pixels: F32, uv: NDArray[np.floating], wrap: tuple[str, str]) -> F32:
    # As a sampler wraps: repeated, mirrored every other time, or held at the rim.
    cells = []
    for axis, size in ((0, pixels.shape[1]), (1, pixels.shape[0])):
        i = np.floor(uv[:, axis] * size).astype(np.int64)
        if wrap[axis] == "repeat":
            i = i % size
        elif wrap[axis] == "mirror":
            i = i % (2 * size)
            i = np.minimum(i, 2 * size - 1 - i)
        cells.append(np.clip(i, 0, size - 1))
    texels: F32 = pixels[cells[1], cells[0]]
    return texels
