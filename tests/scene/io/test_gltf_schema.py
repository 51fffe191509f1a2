"""Keys that glTF does not have, and values out of their range, are warnings that name them."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.scene import Camera
from airlight.scene.io.gltf import load_gltf
from airlight.scene.io.gltf_schema import _EXTENSIONS, _OBJECTS

PBR = "pbrMetallicRoughness"


def worn(draft: Any, material: dict[str, Any], **more: Any) -> list[str]:
    """The warnings of a triangle that wears `material`."""
    primitive = draft.triangle()
    primitive["material"] = 0
    draft.single(primitive)
    draft.json |= {"materials": [material], **more}
    return list(load_gltf(draft.glb()).warnings)


@pytest.mark.parametrize(
    ("material", "words"),
    [
        ({PBR: {"roughnessFactor": 7}}, f"{PBR}.roughnessFactor is 7, above 1: the nearest"),
        ({PBR: {"metallicFactor": -1}}, f"{PBR}.metallicFactor is -1, below 0"),
        ({PBR: {"baseColorFactor": [0.5, -3, 0, 1]}}, "baseColorFactor[1] is -3, below 0"),
        ({"emissiveFactor": [-1, 0, 0]}, "emissiveFactor[0] is -1, below 0"),
        ({"alphaMode": "MASK", "alphaCutoff": -0.5}, "alphaCutoff is -0.5, below 0"),
        ({"doubleSided": 1}, "doubleSided is 1: false is taken"),
        ({PBR: {"roughnesFactor": 0.1}}, "the key 'roughnesFactor' is unknown and left out. Did"),
        ({"emissivFactor": [1, 1, 1]}, "Did you mean 'emissiveFactor'?"),
        ({"technique": "lambert"}, "the key 'technique' is unknown and left out"),
        (
            {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 2}}},
            "KHR_materials_transmission.transmissionFactor is 2, above 1",
        ),
        (
            {"extensions": {"KHR_materials_emissive_strength": {"emissiveStrenght": 5}}},
            "Did you mean 'emissiveStrength'?",
        ),
    ],
)
def test_a_material_that_asks_for_what_there_is_not(draft: Any, material: Any, words: str) -> None:
    said = [text for text in worn(draft, material) if words in text]
    assert len(said) == 1 and "materials[0]" in said[0]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"scens": []}, "the key 'scens' is unknown and left out. Did you mean 'scenes'?"),
        ({"cameras": [{"type": "perspectiv"}]}, "cameras[0].type is 'perspectiv', which is"),
        ({"samplers": [{"wrapS": 1}]}, "samplers[0].wrapS is '1', which is unknown. Known: 33071"),
        ({"textures": [{"source": 3}]}, "textures[0].source is 3, but the file has 0 images"),
        ({"materials": [{}, {"alphaMode": "BLEN"}]}, "materials[1].alphaMode is 'BLEN', which is"),
        (
            {"materials": [{}, {"normalTexture": {"index": 9}}]},
            "materials[1].normalTexture.index is 9, but the file has 0 textures",
        ),
        (
            {"extensions": {"KHR_lights_punctual": {"lights": [{"type": "spt"}]}}},
            "lights[0].type is 'spt', which is unknown. Known: directional, point, spot",
        ),
        (
            {"extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": -2,
             "spot": {"outerConeAngle": 3}}]}}},
            "lights[0].intensity is -2, below 0",
        ),
        ({"nodes": [{"mesh": 0, "translate": [0, 0, 0]}]}, "nodes[0]: the key 'translate' is"),
    ],
)  # fmt: skip
def test_other_objects_that_ask_for_what_there_is_not(draft: Any, more: Any, words: str) -> None:
    """Whether or not anything that is shown refers to them."""
    said = worn(draft, {}, **more)
    assert len([text for text in said if words in text]) == 1, said


def test_attributes_are_known_by_their_names(draft: Any) -> None:
    primitive = draft.triangle(NORMALS=0, _ID=0, COLOR_0=0)
    said = load_gltf(draft.single(primitive).glb()).warnings
    assert [text for text in said if "attribute" in text] == [
        f"{draft.folder / 'thing.glb'}: meshes[0].primitives[0].attributes: the attribute "
        "'NORMALS' is unknown"
    ]


def test_a_number_beyond_all_floats_is_left_to_its_reader(draft: Any) -> None:
    document = draft.single(draft.triangle()).gltf()
    values = json.loads(document.read_text())
    values["materials"] = [{PBR: {"metallicFactor": 10**400}}]
    values["meshes"][0]["primitives"][0]["material"] = 0
    document.write_text(json.dumps(values))
    with pytest.raises(SceneError, match="metallicFactor"):
        load_gltf(document)


def test_the_same_doubt_about_many_objects_is_told_once(draft: Any) -> None:
    many = [{"alphaMode": "BLEN"}] * 5
    said = [t for t in worn(draft, {}, materials=[{}, *many]) if "BLEN" in t]
    assert len(said) == 1 and said[0].endswith("(and 4 more)")


def test_what_glTF_allows_is_no_doubt(draft: Any) -> None:
    """Extras of any kind, names, and every key of the tables."""
    free = {"extras": {"anything": {"roughnessFactor": 7}}, "name": "a"}
    said = worn(draft, {**free, PBR: {"roughnessFactor": 1, **free}, "emissiveFactor": [9, 0, 0],
                         "doubleSided": None, "alphaMode": None})  # fmt: skip
    assert said == []


@pytest.mark.parametrize("yfov", [0.0, -1.0, math.pi, None])
def test_a_camera_of_no_field_of_view_is_left_out(draft: Any, yfov: float | None) -> None:
    draft.single(draft.triangle(), camera=0)
    lens = {"znear": 0.1} if yfov is None else {"yfov": yfov, "znear": 0.1}
    draft.json["cameras"] = [{"type": "perspective", "perspective": lens}]
    scene = load_gltf(draft.glb())
    assert scene.camera == Camera()
    assert any("is no field of view: it is left out" in text for text in scene.warnings)


def test_a_camera_of_no_shape_has_the_usual_one(draft: Any) -> None:
    draft.single(draft.triangle(), camera=0)
    lens = {"yfov": 1.0, "znear": 0.1, "aspectRatio": 0.0}
    draft.json["cameras"] = [{"type": "perspective", "perspective": lens}]
    scene = load_gltf(draft.glb())
    assert scene.camera.film_px is None and scene.camera != Camera()
    assert any("its aspectRatio 0 is left out" in text for text in scene.warnings)


def test_a_cutoff_above_one_leaves_nothing(draft: Any) -> None:
    """Specification, 5.19.8: the whole material is rendered as fully transparent."""
    primitive = draft.triangle()
    primitive["material"] = 0
    draft.single(primitive)
    draft.json["materials"] = [{"alphaMode": "MASK", "alphaCutoff": 1.5}]
    material = load_gltf(draft.glb()).meshes[0].material
    assert material.alpha < material.alpha_cutoff


def test_coordinates_that_a_surface_lacks_are_named(draft: Any) -> None:
    pixel = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg=="  # noqa: E501
    more = {
        "images": [{"uri": f"data:image/png;base64,{pixel}"}],
        "textures": [{"source": 0}],
    }
    said = worn(draft, {PBR: {"baseColorTexture": {"index": 0, "texCoord": 1}}}, **more)
    assert any("meshes[0].primitives[0]: it has no TEXCOORD_1" in text for text in said)


def test_a_later_version_is_named(draft: Any) -> None:
    asset = {"version": "2.1", "minVersion": "2.1"}
    said = worn(draft, {}, asset=asset)
    assert any("it asks for glTF 2.1, and is read as 2.0" in text for text in said)


def test_every_object_of_the_tables_has_a_table() -> None:
    for keys in (*_OBJECTS.values(), *_EXTENSIONS.values()):
        for rule in keys.values():
            assert not rule.of or rule.of in _OBJECTS or rule.of == "attributes"


def test_deep_documents_are_walked(draft: Any) -> None:
    nodes = [{"children": [k + 1], "tranlation": [0, 0, 0]} for k in range(3000)]
    draft.single(draft.triangle())
    draft.json["nodes"] = [*nodes, {"mesh": 0}]
    said = load_gltf(draft.glb()).warnings
    assert any("Did you mean 'translation'?" in t and "(and 2,999 more)" in t for t in said)


@pytest.mark.parametrize("command", ["validate", "info", "render"])
def test_commands_agree(draft: Any, command: str, tmp_path: Any, capsys: Any, gpu: Any) -> None:
    primitive = draft.triangle()
    primitive["material"] = 0
    draft.single(primitive)
    draft.json["materials"] = [{PBR: {"roughnessFactor": 7, "metalic": 1}}]
    path = draft.gltf()
    more = ["-o", str(tmp_path / "o.png"), "--size", "16x16"] if command == "render" else []
    assert run([command, str(path), *more]) == 0
    told = capsys.readouterr().err
    assert "roughnessFactor is 7, above 1" in told and "'metalic' is unknown" in told


def test_what_is_shown_and_cannot_be_is_still_refused(draft: Any) -> None:
    with pytest.raises(SceneError, match="alphaMode: 'BLEN' is unknown"):
        worn(draft, {"alphaMode": "BLEN"})
