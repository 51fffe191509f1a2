"""The objects of a glTF document: their keys, and the values that these may have.

A key that is misspelt, and a value that readers clamp, change what is shown without an error, so
each is a warning that names it. What readers refuse themselves is not repeated here.

Source: Khronos, glTF 2.0 specification, section 5 (properties reference), and the extensions' own.
"""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ...errors import Kinds, left_out
from .gltf_compressed import DRACO, MESHOPT
from .gltf_json import Item

_COMMON = ("name", "extras", "extensions")
_MOST = 1e300  # an integer beyond all floats is left to whoever reads it
_ATTRIBUTE = re.compile(r"POSITION|NORMAL|TANGENT|(TEXCOORD|COLOR|JOINTS|WEIGHTS)_\d+|_.*")


@dataclass(frozen=True)
class Rule:
    """What a key's value, or each element of its list, may be.

    `of`: an object of that kind; `index`: a number in the document's list of that name; `choices`;
    `low` and `high` for numbers; `is_flag`: true or false.
    """

    of: str = ""
    index: str = ""
    choices: tuple[Any, ...] = ()
    low: float = -math.inf
    high: float = math.inf
    is_flag: bool = False


Keys = Mapping[str, Rule]
_FLAG, _UNIT, _LEAST_0 = Rule(is_flag=True), Rule(low=0.0, high=1.0), Rule(low=0.0)
_IMAGE = Rule("texture info")


def _of(**kinds: str) -> Keys:
    return {key: Rule(kind) for key, kind in kinds.items()}


def _indices(**lists: str) -> Keys:
    return {key: Rule(index=name) for key, name in lists.items()}


def _free(words: str) -> Keys:
    """Keys whose values readers check, or that change nothing that is shown."""
    return dict.fromkeys(words.split(), Rule())


_TEXTURE_INFO = {**_indices(index="textures"), "texCoord": _LEAST_0}
_WRAP = Rule(choices=(33071, 33648, 10497))
_OBJECTS: dict[str, Keys] = {
    "document": {
        **_of(asset="asset", scenes="scene", nodes="node", meshes="mesh", cameras="camera"),
        **_of(animations="animation", skins="skin", materials="material", textures="texture"),
        **_of(images="image", samplers="sampler", accessors="accessor", buffers="buffer"),
        **_of(bufferViews="buffer view"),
        **_free("scene extensionsUsed extensionsRequired"),
    },
    "asset": _free("version generator copyright minVersion"),
    "scene": _indices(nodes="nodes"),
    "node": {
        **_indices(camera="cameras", children="nodes", skin="skins", mesh="meshes"),
        **_free("matrix rotation scale translation weights"),
    },
    "mesh": {**_of(primitives="primitive"), **_free("weights")},
    "primitive": {
        **_of(attributes="attributes", targets="attributes"),
        **_indices(indices="accessors", material="materials"),
        **_free("mode"),
    },
    "camera": {
        **_of(perspective="perspective", orthographic="orthographic"),
        "type": Rule(choices=("perspective", "orthographic")),
    },
    "perspective": _free("aspectRatio yfov zfar znear"),
    "orthographic": _free("xmag ymag zfar znear"),
    "material": {
        **_of(pbrMetallicRoughness="metallic-roughness", occlusionTexture="occlusion"),
        **_of(normalTexture="normal image", emissiveTexture="texture info"),
        "emissiveFactor": _LEAST_0,
        "alphaMode": Rule(choices=("OPAQUE", "MASK", "BLEND")),
        "alphaCutoff": _LEAST_0,
        "doubleSided": _FLAG,
    },
    "metallic-roughness": {
        "baseColorFactor": _UNIT,
        "metallicFactor": _UNIT,
        "roughnessFactor": _UNIT,
        **dict.fromkeys(("baseColorTexture", "metallicRoughnessTexture"), _IMAGE),
    },
    "texture info": _TEXTURE_INFO,
    "normal image": {**_TEXTURE_INFO, **_free("scale")},
    "occlusion": {**_TEXTURE_INFO, **_free("strength")},
    "texture": _indices(sampler="samplers", source="images"),
    "sampler": {
        "magFilter": Rule(choices=(9728, 9729)),
        "minFilter": Rule(choices=(9728, 9729, 9984, 9985, 9986, 9987)),
        **dict.fromkeys(("wrapS", "wrapT"), _WRAP),
    },
    "image": {**_indices(bufferView="bufferViews"), **_free("uri mimeType")},
    "animation": _of(channels="channel", samplers="animation sampler"),
    "channel": {**_of(target="target"), **_free("sampler")},
    "target": {
        **_indices(node="nodes"),
        "path": Rule(choices=("translation", "rotation", "scale", "weights", "pointer")),
    },
    "animation sampler": {
        **_indices(input="accessors", output="accessors"),
        "interpolation": Rule(choices=("LINEAR", "STEP", "CUBICSPLINE")),
    },
    "skin": _indices(inverseBindMatrices="accessors", skeleton="nodes", joints="nodes"),
    "accessor": {
        **_of(sparse="sparse"),
        **_indices(bufferView="bufferViews"),
        "normalized": _FLAG,
        **_free("byteOffset componentType count type max min"),
    },
    "sparse": {**_of(indices="sparse part", values="sparse part"), **_free("count")},
    "sparse part": _free("bufferView byteOffset componentType"),
    "buffer view": {
        **_indices(buffer="buffers"),
        **_free("byteOffset byteLength byteStride target"),
    },
    "buffer": _free("uri byteLength"),
    "light": {
        "type": Rule(choices=("directional", "point", "spot")),
        "color": _LEAST_0,
        "intensity": _LEAST_0,
        "range": _LEAST_0,
        **_of(spot="spot"),
    },
    "spot": {
        "innerConeAngle": Rule(low=0.0, high=math.pi / 2.0),
        "outerConeAngle": Rule(low=0.0, high=math.pi / 2.0),
    },
    "variant": {},
    "mapping": {**_indices(material="materials"), **_free("variants")},
}
_MESHOPT_VIEW = {
    **_indices(buffer="buffers"),
    **_free("byteOffset byteLength byteStride count mode filter fallback"),
}
_EXTENSIONS: dict[str, Keys] = {
    "KHR_lights_punctual": {**_of(lights="light"), **_free("light")},
    "KHR_texture_transform": {**_free("offset rotation scale"), "texCoord": _LEAST_0},
    "KHR_materials_emissive_strength": {"emissiveStrength": _LEAST_0},
    "KHR_materials_ior": {"ior": _LEAST_0},
    "KHR_materials_transmission": {"transmissionFactor": _UNIT, "transmissionTexture": _IMAGE},
    "KHR_materials_specular": {
        "specularFactor": _UNIT,
        "specularColorFactor": _LEAST_0,
        **dict.fromkeys(("specularTexture", "specularColorTexture"), _IMAGE),
    },
    "KHR_materials_pbrSpecularGlossiness": {
        **dict.fromkeys(("diffuseFactor", "specularFactor", "glossinessFactor"), _UNIT),
        **dict.fromkeys(("diffuseTexture", "specularGlossinessTexture"), _IMAGE),
    },
    "KHR_materials_unlit": {},
    "KHR_materials_variants": {**_of(variants="variant", mappings="mapping")},
    "KHR_texture_basisu": _indices(source="images"),
    "EXT_texture_webp": _indices(source="images"),
    "EXT_mesh_gpu_instancing": _free("attributes"),
    DRACO: {**_indices(bufferView="bufferViews"), **_free("attributes")},
    **{name: _MESHOPT_VIEW for name in MESHOPT},
}
"""Of the extensions that are read, their keys. Others are named as a whole."""


def schema_doubts(document: Item) -> list[str]:
    """A warning for each key that glTF does not have, and each value out of its range.

    Of the same doubt about many objects the first is named, with how many more there are.
    """
    kinds = Kinds()
    for key, text in _doubts(document):
        kinds.note(key, f"{document.file}: {text}")
    return kinds.texts()


def _doubts(document: Item) -> Iterator[tuple[Any, str]]:
    """Each doubt, with what makes it the same as another one."""
    # A queue instead of recursion: documents may be nested deeply.
    pending = deque([(document, "document", _OBJECTS["document"])])
    while pending:
        item, kind, keys = pending.popleft()
        # A value of another type than an object is refused by whoever reads it.
        for key in item.value if isinstance(item.value, dict) else ():
            if key == "extensions":
                pending += _extensions(item.child(key))
            elif kind == "attributes":
                if not _ATTRIBUTE.fullmatch(key):
                    yield (kind, key), f"{item.place}: the attribute '{key}' is unknown"
            elif key not in keys and key not in _COMMON:
                at = f"{item.place}: " if item.place else ""
                yield (kind, key), at + left_out("key", key, keys)
            elif key in keys and item.has(key):
                rule = keys[key]
                if rule.of:
                    pending += [(e, rule.of, _OBJECTS.get(rule.of, {})) for e in _each(item, key)]
                for element in _each(item, key):
                    problem = _problem(element.value, rule, document)
                    if problem:
                        yield (kind, key, problem), f"{element.place} {problem}"


def _extensions(held: Item) -> list[tuple[Item, str, Keys]]:
    """The extensions of an object that are read."""
    names = held.value if isinstance(held.value, dict) else ()
    return [(held.child(name), name, _EXTENSIONS[name]) for name in names if name in _EXTENSIONS]


def _each(item: Item, key: str) -> list[Item]:
    child = item.child(key)
    return item.items(key) if isinstance(child.value, list) else [child]


def _problem(value: Any, rule: Rule, document: Item) -> str:
    """What is wrong with a value, "" for nothing."""
    if rule.is_flag:
        return "" if isinstance(value, bool) else f"is {value!r}: false is taken"[:80]
    if rule.choices and value not in rule.choices:
        known = ", ".join(str(choice) for choice in rule.choices)
        return f"is {str(value)[:40]!r}, which is unknown. Known: {known}."
    # Numbers; whatever else stands there is refused by whoever reads it.
    if isinstance(value, bool) or not isinstance(value, (int, float)) or abs(value) > _MOST:
        return ""
    if rule.index:
        listed = document.value.get(rule.index)
        count = len(listed) if isinstance(listed, list) else 0
        return "" if value < count else f"is {value}, but the file has {count} {rule.index}"
    if value < rule.low:
        return f"is {value:g}, below {rule.low:g}: the nearest that is possible is taken"
    if value > rule.high:
        return f"is {value:g}, above {rule.high:g}: the nearest that is possible is taken"
    return ""
