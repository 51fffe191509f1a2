"""Scenes as GLB files: meshes with materials and textures, punctual lights, the camera.

glTF 2.0 with KHR_lights_punctual, KHR_materials_emissive_strength, KHR_materials_specular and
KHR_texture_transform, in the units that `gltf` reads: a W sr^-1 is a candela. An area light that is
seen is an emissive mesh, which reading takes for the same light.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Hashable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ...maths.transforms import triple
from ..camera import Camera
from ..checks import F32, F64
from ..light_shapes import LightMeshes
from ..lights import Light, PointLight
from ..mesh import Geometry, Mesh, in_world, unit_or_up
from ..scene import Scene
from .files import opened
from .gltf import WATTS_PER_LUMEN
from .gltf_write_material import material_json, texture_png
from .ledger import own_files
from .writing import whole_file

Json = dict[str, Any]
_FLOAT, _UINT = 5126, 5125
_VERTICES, _INDICES = 34962, 34963
_HEAD_BYTES = 400  # the asset is the first thing that a document says
_SHEAR = 1e-6  # cosine between axes from which on a placement is no turn and scale
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def write_gltf(scene: Scene, path: Path) -> list[str]:
    """Write `scene` as a .glb file, whole or not at all.

    Returns what glTF cannot say, a sentence each. Raises OutputError.
    """
    document = GlbDocument()
    for mesh in LightMeshes().of(scene).meshes:
        document.add_mesh(mesh)
    # A group of point lights has no word in glTF: each becomes a light of its own.
    for light in scene.lights:
        document.add_light(light)
    for group in scene.light_groups:
        intensities = np.broadcast_to(group.intensities, group.positions.shape)
        for position, intensity in zip(group.positions, intensities, strict=True):
            document.add_light(PointLight(triple(position), triple(intensity)))
    document.add_camera(scene.camera)
    # The file appears when it is complete, so that a reader never sees half of it.
    with whole_file(Path(path)) as part:
        part.write_bytes(document.packed())
    return [*dict.fromkeys(document.notes), *_left_out(scene)]


def is_written_here(path: Path) -> bool:
    """Whether a file begins as `write_gltf` writes it."""
    try:
        with own_files(), opened(path) as file:
            head = file.read(_HEAD_BYTES).replace(b" ", b"")
    except SceneError:
        return False
    return head.startswith(b"glTF") and b'"generator":"airlight"' in head


def _left_out(scene: Scene) -> list[str]:
    """What a glTF file has no place for."""
    held = {
        "the environment": scene.environment is not None,
        "the medium": scene.medium is not None,
        "volumes": bool(scene.volumes),
        "the animation: the scene is written as it stands": scene.animation is not None,
        "the settings of techniques": bool(scene.settings),
    }
    return [f"glTF has no place for {name}" for name, is_there in held.items() if is_there]


class GlbDocument:
    """A document as it grows: what is the same object is written once."""

    def __init__(self) -> None:
        self.notes: list[str] = []
        self._json: Json = {"asset": {"version": "2.0", "generator": "airlight"}, "scene": 0}
        self._binary = bytearray()
        self._rows: dict[tuple[str, Hashable], int] = {}
        self._kept: list[object] = []  # what keys name by identity
        self._nodes: list[Json] = []
        self._extensions: set[str] = set()

    def add_mesh(self, mesh: Mesh) -> None:
        """A node with the mesh; its geometry is shared by all of its instances."""
        geometry, placed = mesh.geometry, mesh.world_from_object
        # Readers take a placement apart into turn and scale, so shear goes into the vertices.
        if _is_sheared(placed):
            geometry, placed = in_world(mesh), np.eye(4)
        key = (id(geometry), id(mesh.material))
        self._kept += [geometry, mesh.material]
        row = self._row("meshes", key, lambda: self._mesh(geometry, mesh))
        self._node(placed, {"mesh": row, "name": mesh.name})

    def add_light(self, light: Light) -> None:
        """A node with a punctual light that goes along its -Z."""
        found = light.punctual(self.notes)
        if found is None:
            return
        # Colour and strength apart, as glTF has them.
        strength = max(found.strength)
        scale = strength if strength > 0.0 else 1.0
        item: Json = {
            "type": light.type_name,
            "color": [c / scale for c in found.strength],
            "intensity": strength / WATTS_PER_LUMEN,
        }
        if found.cone_deg is not None:
            inner, outer = np.radians(found.cone_deg)
            item["spot"] = {"innerConeAngle": float(inner), "outerConeAngle": float(outer)}
        # The light in the document's list, and a node that places it.
        lights = self._listed("KHR_lights_punctual", "lights")
        lights.append(item)
        turned = _facing(np.array(found.direction), np.array((0.0, 1.0, 0.0)))
        turned[:3, 3] = found.position
        hung = {"KHR_lights_punctual": {"light": len(lights) - 1}}
        self._node(turned, {"extensions": hung})

    def add_camera(self, camera: Camera) -> None:
        """A perspective camera of that field of view, of no limits but those it must have."""
        eye, target = np.array(camera.position), np.array(camera.target)
        distance = float(np.linalg.norm(target - eye))
        placed = _facing((target - eye) / distance, np.array(camera.up))
        placed[:3, 3] = eye
        # Planes that clip: near by a thousandth of what is looked at, none afar.
        lens = {"yfov": float(np.radians(camera.fov_y_deg)), "znear": 1e-3 * distance}
        if camera.film_px is not None:
            lens["aspectRatio"] = camera.film_px[0] / camera.film_px[1]
        self._json.setdefault("cameras", []).append({"type": "perspective", "perspective": lens})
        self._node(placed, {"camera": 0, "name": "camera"})

    def packed(self) -> bytes:
        """The file: a header, the JSON, and what it refers to."""
        # All nodes hang at the top: placements are in the world already.
        self._json["nodes"] = self._nodes
        self._json["scenes"] = [{"nodes": list(range(len(self._nodes)))}]
        if self._binary:
            self._json["buffers"] = [{"byteLength": len(self._binary)}]
        if self._extensions:
            self._json["extensionsUsed"] = sorted(self._extensions)
        # Chunks are padded to four bytes: JSON by spaces, binary by zeros.
        text = json.dumps(self._json, separators=(",", ":"), ensure_ascii=False).encode()
        chunks = [(_JSON_CHUNK, text + b" " * (-len(text) % 4))]
        if self._binary:
            chunks.append((_BINARY_CHUNK, bytes(self._binary) + bytes(-len(self._binary) % 4)))
        body = b"".join(struct.pack("<II", len(data), kind) + data for kind, data in chunks)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body

    def _row(self, table: str, key: Hashable, make: Callable[[], Json]) -> int:
        """The row of a table that `key` names, made where it is the first time."""
        known = self._rows.get((table, key))
        if known is None:
            made = make()
            rows = self._json.setdefault(table, [])
            rows.append(made)
            known = self._rows[table, key] = len(rows) - 1
        return known

    def _listed(self, extension: str, name: str) -> list[Json]:
        self._extensions.add(extension)
        held = self._json.setdefault("extensions", {}).setdefault(extension, {name: []})
        rows: list[Json] = held[name]
        return rows

    def _node(self, placed: F64, item: Json) -> None:
        if not np.array_equal(placed, np.eye(4)):
            item["matrix"] = placed.T.ravel().tolist()  # columns first
        self._nodes.append({key: value for key, value in item.items() if value != ""})

    def _mesh(self, geometry: Geometry, mesh: Mesh) -> Json:
        # Materials and arrays are shared, so each is written once.
        material = self._row(
            "materials",
            id(mesh.material),
            lambda: material_json(mesh.material, self._texture, self._extensions, self.notes),
        )
        values: dict[str, F32 | None] = {
            "POSITION": geometry.positions,
            "NORMAL": geometry.normals,
            "TEXCOORD_0": geometry.uvs,
            "COLOR_0": geometry.colors,
            "TANGENT": geometry.tangents,
        }
        attributes = {
            name: self._accessor(array, name) for name, array in values.items() if array is not None
        }
        indices = self._accessor(geometry.indices.reshape(-1), "")
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        return {"primitives": [primitive]} | ({"name": mesh.name} if mesh.name else {})

    def _accessor(self, array: NDArray[Any], attribute: str) -> int:
        self._kept.append(array)
        key = (id(array), attribute)
        return self._row("accessors", key, lambda: self._accessor_json(array, attribute))

    def _accessor_json(self, array: NDArray[Any], attribute: str) -> Json:
        # Indices have no attribute to be named by.
        is_index = not attribute
        packed = np.ascontiguousarray(array, "<u4" if is_index else "<f4")
        if attribute == "NORMAL":
            packed = unit_or_up(packed)
        if attribute == "TANGENT":
            # Those of no length say that maps lie by coordinates, and stay.
            length = np.linalg.norm(packed[:, :3], axis=1, keepdims=True)
            unit = packed[:, :3] / np.where(length > 0.0, length, 1.0)
            packed = np.concatenate([unit, packed[:, 3:]], axis=1, dtype=np.float32)
        width = 1 if is_index else packed.shape[1]
        item: Json = {
            "bufferView": self._view(packed.tobytes(), _INDICES if is_index else _VERTICES),
            "componentType": _UINT if is_index else _FLOAT,
            "count": len(packed),
            "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}[width],
        }
        # glTF requires the bounds of positions.
        if attribute == "POSITION":
            item["min"], item["max"] = packed.min(axis=0).tolist(), packed.max(axis=0).tolist()
        return item

    def _view(self, data: bytes, target: int | None = None) -> int:
        self._binary += bytes(-len(self._binary) % 4)
        view: Json = {"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(data)}
        self._binary += data
        rows = self._json.setdefault("bufferViews", [])
        rows.append(view if target is None else view | {"target": target})
        return len(rows) - 1

    def _texture(self, pixels: NDArray[np.uint8], sampler: Json) -> int:
        """The row of a texture of these pixels."""
        self._kept.append(pixels)
        image = self._row("images", id(pixels), lambda: self._image(pixels))
        key = tuple(sorted(sampler.items()))
        row = self._row("samplers", key, lambda: sampler)
        return self._row("textures", (image, row), lambda: {"source": image, "sampler": row})

    def _image(self, pixels: NDArray[np.uint8]) -> Json:
        data = BytesIO()
        texture_png(pixels, data)
        return {"bufferView": self._view(data.getvalue()), "mimeType": "image/png"}


def _facing(direction: F64, up: F64) -> F64:
    """A turn (4, 4) whose -Z is `direction` and whose +Y is as near to `up` as can be."""
    side = np.cross(direction, up)
    if np.linalg.norm(side) < 1e-6:
        side = np.cross(direction, (0.0, 0.0, 1.0) if abs(direction[2]) < 0.9 else (1.0, 0.0, 0.0))
    side = side / np.linalg.norm(side)
    turned = np.eye(4)
    turned[:3, :3] = np.stack([side, np.cross(side, direction), -direction], axis=1)
    return turned


def _is_sheared(placed: F64) -> bool:
    """Whether a placement is more than a turn, a scale along its axes, and a shift."""
    axes = placed[:3, :3] / np.maximum(np.linalg.norm(placed[:3, :3], axis=0), 1e-30)
    return bool(np.abs(axes.T @ axes - np.eye(3)).max() > _SHEAR)
