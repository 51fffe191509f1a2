"""Good documents that use much of what their format has: a scene file, a glTF, a Mitsuba scene."""

from __future__ import annotations

import base64
import itertools
import tomllib
from typing import Any

import numpy as np

from . import seeds
from .mutate_tree import Words

# ---- Scene files -------------------------------------------------------------------------------

SCENE_FILES: seeds.Files = {
    "thing.obj": seeds.OBJ,
    "thing.mtl": seeds.MTL,
    "thing.ply": seeds.PLY,
    "smoke.npy": seeds.npy(seeds.smoke()),
    "frames/f_1.npy": seeds.npy(seeds.smoke()),
    "frames/f_2.npy": seeds.npy(seeds.smoke() * 0.5),
    "t.png": seeds.image("PNG"),
    "lights.npz": seeds.npz(positions=np.ones((3, 3)), intensities=np.ones((3, 3))),
}


def scene_table() -> dict[str, Any]:
    """Every table of a scene file, keyframes included."""
    return tomllib.loads((seeds.GOOD / "scene.toml").read_text(encoding="utf-8"))


def scene_words() -> Words:
    """The names that `toml_tables` knows."""
    from airlight.scene.io.toml_keys import KEYS
    from airlight.scene.io.toml_tables import TABLES

    tables = (*TABLES, *KEYS.values())
    variants = [keys for table in tables for keys in (table.variants or {}).values()]
    named = itertools.chain(*(table.keys for table in tables), *variants)
    keys = sorted({key.name for key in named} | {"key", "technique", *(t.name for t in TABLES)})
    values = (
        *SCENE_FILES,
        "thing.gltf",
        "scene.toml",
        "box",
        "sphere",
        "plane",
        "quad",
        "points",
        "spot",
        "directional",
        "point",
        "auto",
        "smooth",
        "linear",
        "step",
        "density",
        "r",
        "a",
        "frames",
    )
    return Words(tuple(keys), values)


# ---- glTF --------------------------------------------------------------------------------------


class _Binary:
    """The arrays of a glTF, one after the other, each with a view and an accessor."""

    def __init__(self) -> None:
        self.bytes = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, raw: bytes) -> int:
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(raw)})
        self.bytes += raw
        return len(self.views) - 1

    def array(self, values: Any, dtype: str, kind: str) -> int:
        codes = {"u1": 5121, "u2": 5123, "u4": 5125, "f4": 5126}
        array = np.asarray(values, f"<{dtype}")
        self.accessors.append(
            {
                "bufferView": self.view(array.tobytes()),
                "componentType": codes[dtype],
                "count": len(array),
                "type": kind,
            }
        )
        return len(self.accessors) - 1


def _animations(binary: _Binary) -> list[dict[str, Any]]:
    times = binary.array([0.0, 0.5, 1.0], "f4", "SCALAR")
    turns = binary.array([(0, 0, 0, 1), (0, 1, 0, 0), (0, 0, 0, 1)], "f4", "VEC4")
    moves = binary.array(np.ones((9, 3)), "f4", "VEC3")
    weights = binary.array([0.0, 0.5, 1.0], "f4", "SCALAR")
    return [
        {
            "name": "turn",
            "samplers": [
                {"input": times, "output": turns, "interpolation": "LINEAR"},
                {"input": times, "output": moves, "interpolation": "CUBICSPLINE"},
                {"input": times, "output": weights, "interpolation": "STEP"},
            ],
            "channels": [
                {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
                {"sampler": 1, "target": {"node": 2, "path": "translation"}},
                {"sampler": 2, "target": {"node": 0, "path": "weights"}},
            ],
        }
    ]


def gltf() -> tuple[dict[str, Any], bytes]:
    """A document (without its buffer's uri) and its buffer: skin, morph target, clip, textures."""
    binary = _Binary()
    positions = binary.array(seeds.CORNERS, "f4", "VEC3")
    binary.accessors[positions] |= {"min": [0, 0, 0], "max": [1, 1, 0.5]}
    attributes = {
        "POSITION": positions,
        "NORMAL": binary.array([(0, 0, 1)] * 4, "f4", "VEC3"),
        "TANGENT": binary.array([(1, 0, 0, 1)] * 4, "f4", "VEC4"),
        "TEXCOORD_0": binary.array([(0, 0), (1, 0), (1, 1), (0, 1)], "f4", "VEC2"),
        "COLOR_0": binary.array([(255, 128, 0, 255)] * 4, "u1", "VEC4"),
        "JOINTS_0": binary.array([(0, 1, 0, 0)] * 4, "u1", "VEC4"),
        "WEIGHTS_0": binary.array([(0.5, 0.5, 0, 0)] * 4, "f4", "VEC4"),
    }
    binary.accessors[attributes["COLOR_0"]]["normalized"] = True
    indices = binary.array(seeds.TRIANGLES.ravel(), "u2", "SCALAR")
    morph = binary.array(seeds.CORNERS * 0.1, "f4", "VEC3")
    sparse = {
        "count": 1,
        "indices": {"bufferView": binary.view(b"\1\0"), "componentType": 5123},
        "values": {"bufferView": binary.view(np.ones(3, "<f4").tobytes())},
    }
    binary.accessors[morph]["sparse"] = sparse
    inverse = binary.array(np.tile(np.eye(4), (2, 1, 1)).reshape(2, 16), "f4", "MAT4")
    image = binary.view(seeds.image("PNG"))
    animations = _animations(binary)
    document = {
        "asset": {"version": "2.0", "generator": "seeds"},
        "scene": 0,
        "scenes": [{"name": "all", "nodes": [0, 3, 4]}],
        "nodes": [
            {"name": "body", "mesh": 0, "skin": 0, "children": [1], "weights": [0.2]},
            {"name": "a", "rotation": [0, 0, 0, 1], "children": [2], "scale": [1, 1, 1]},
            {"name": "b", "translation": [0, 1, 0]},
            {
                "name": "eye",
                "camera": 0,
                "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1],
            },
            {"mesh": 1, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "meshes": [
            {
                "name": "skin",
                "weights": [0.5],
                "primitives": [
                    {
                        "attributes": attributes,
                        "indices": indices,
                        "material": 0,
                        "targets": [{"POSITION": morph}],
                    }
                ],
            },
            {
                "primitives": [
                    {"attributes": {"POSITION": positions}, "mode": 5, "material": 1},
                    {"attributes": {"POSITION": positions}, "mode": 0},
                ]
            },
        ],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": inverse, "skeleton": 1}],
        "cameras": [
            {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5}}
        ],
        "materials": _materials(),
        "textures": [{"source": 0, "sampler": 0}, {"source": 1}],
        "images": [{"bufferView": image, "mimeType": "image/png"}, {"uri": "t.png"}],
        "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9729}],
        "animations": animations,
        "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"],
        "extensionsRequired": ["KHR_texture_transform"],
        "extensions": {
            "KHR_lights_punctual": {
                "lights": [
                    {
                        "type": "spot",
                        "intensity": 100,
                        "color": [1, 0.9, 0.8],
                        "range": 10,
                        "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5},
                    }
                ]
            }
        },
        "bufferViews": binary.views,
        "accessors": binary.accessors,
        "buffers": [{"byteLength": len(binary.bytes)}],
    }
    return document, bytes(binary.bytes)


def _materials() -> list[dict[str, Any]]:
    placed = {"KHR_texture_transform": {"offset": [0.5, 0], "scale": [2, 2], "rotation": 0.3}}
    return [
        {
            "name": "skin",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.8, 0.7, 0.6, 1],
                "metallicFactor": 0.2,
                "roughnessFactor": 0.6,
                "baseColorTexture": {"index": 0, "extensions": placed},
                "metallicRoughnessTexture": {"index": 1, "texCoord": 0},
            },
            "normalTexture": {"index": 1, "scale": 0.5},
            "occlusionTexture": {"index": 1, "strength": 0.5},
            "emissiveFactor": [0.1, 0.2, 0.3],
            "emissiveTexture": {"index": 1},
            "alphaMode": "MASK",
            "alphaCutoff": 0.4,
            "doubleSided": True,
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": 5},
                "KHR_materials_ior": {"ior": 1.4},
                "KHR_materials_specular": {"specularFactor": 0.5},
                "KHR_materials_transmission": {"transmissionFactor": 0.2},
            },
        },
        {
            "extensions": {
                "KHR_materials_pbrSpecularGlossiness": {
                    "diffuseFactor": [1, 1, 1, 1],
                    "glossinessFactor": 0.5,
                    "specularGlossinessTexture": {"index": 0},
                },
                "KHR_materials_unlit": {},
            }
        },
    ]


GLTF_WORDS = Words(
    keys=(
        "nodes",
        "children",
        "mesh",
        "skin",
        "camera",
        "matrix",
        "translation",
        "rotation",
        "scale",
        "weights",
        "byteStride",
        "byteOffset",
        "byteLength",
        "count",
        "sparse",
        "bufferView",
        "uri",
        "indices",
        "targets",
        "mode",
        "normalized",
        "source",
        "index",
        "texCoord",
        "joints",
        "name",
        "extensions",
        "extensionsRequired",
        "KHR_draco_mesh_compression",
        "EXT_mesh_gpu_instancing",
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "orthographic",
        "TEXCOORD_1",
        "COLOR_0",
        "alphaMode",
    ),
    values=(
        "SCALAR",
        "VEC2",
        "VEC3",
        "VEC4",
        "MAT4",
        "LINEAR",
        "CUBICSPLINE",
        "STEP",
        "rotation",
        "weights",
        "BLEND",
        "OPAQUE",
        "perspective",
        "orthographic",
        "point",
        "directional",
        "t.png",
        "thing.bin",
        "thing.gltf",
        "KHR_draco_mesh_compression",
        "KHR_materials_x",
        "image/webp",
    ),
)


def embedded(binary: bytes) -> str:
    """A buffer as a URI."""
    return "data:application/octet-stream;base64," + base64.b64encode(binary).decode()


def glb_of(text: bytes, binary: bytes) -> bytes:
    """A GLB file of a JSON text and a buffer."""
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text
    chunks += len(binary).to_bytes(4, "little") + b"BIN\0" + binary
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks


# ---- Mitsuba -----------------------------------------------------------------------------------

XML = (seeds.GOOD / "scene.xml").read_bytes()
PART = (seeds.GOOD / "part.xml").read_bytes()

XML_WORDS = Words(
    keys=("name", "value", "type", "id", "x", "y", "z", "filename", "angle", "origin", "up"),
    values=(
        "scene",
        "shape",
        "bsdf",
        "emitter",
        "medium",
        "volume",
        "texture",
        "sensor",
        "include",
        "default",
        "ref",
        "alias",
        "path",
        "float",
        "integer",
        "rgb",
        "srgb",
        "spectrum",
        "point",
        "vector",
        "string",
        "boolean",
        "transform",
        "phase",
        "film",
        "wall",
        "air",
        "image",
        "mix",
        "$side",
        "$folder",
        "$$",
        "to_world",
        "radius",
        "reflectance",
        "sigma_t",
        "alpha",
        "fov",
        "width",
        "cube",
        "sphere",
        "gridvolume",
        "thing.obj",
        "part.xml",
        "scene.xml",
        "smoke.vol",
        "t.png",
        "0.5",
        "-1",
        "1e30",
        "1e308",
        "nan",
        "1, 2",
        "1 2 3 4",
        "#12345",
        "true",
        "hg",
        "serialized",
        "instance",
        "shapegroup",
        "constvolume",
        "area",
        "constant",
        "null",
        "GGX",
    ),
)
