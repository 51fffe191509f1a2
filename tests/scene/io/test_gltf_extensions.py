"""Extensions of glTF: read, named in a warning, or refused; never valid without a word."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.scene.io import ktx2
from airlight.scene.io.gltf import load_gltf


def lit(draft, **more):
    draft.single(draft.triangle())
    draft.json |= more
    return draft


@pytest.mark.parametrize(
    "name",
    ["MSFT_lod", "KHR_node_visibility", "ACME_unheard_of", "KHR_xmp"],
)
def test_an_extension_that_is_not_read_is_named(draft, name):
    scene = load_gltf(lit(draft, extensionsUsed=[name]).gltf())
    (line,) = scene.warnings
    assert f"the extension {name} is not read" in line


def test_what_is_read_is_no_warning(draft):
    used = ["KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_ior"]
    assert load_gltf(lit(draft, extensionsUsed=used).gltf()).warnings == ()


@pytest.mark.parametrize("command", ["validate", "info", "render"])
def test_every_command_says_it(draft, command, gpu, tmp_path, capsys):
    path = lit(draft, extensionsUsed=["ACME_unheard_of"]).gltf()
    more = ["-o", str(tmp_path / "o.png"), "--size", "16x16"] if command == "render" else []
    assert run([command, str(path), *more]) == 0
    assert "the extension ACME_unheard_of is not read" in capsys.readouterr().err


def instanced(draft, **attributes):
    extension = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    draft.single(draft.triangle(), translation=[0, 0, 7], extensions=extension)
    draft.json["extensionsUsed"] = draft.json["extensionsRequired"] = [*extension]
    return draft.gltf()


def test_instances_stand_where_their_attributes_say(draft):
    half = np.sqrt(0.5)
    path = instanced(
        draft,
        TRANSLATION=draft.array([(1, 0, 0), (2, 0, 0), (3, 0, 0)], "f4"),
        ROTATION=draft.array([(0, 0, 0, 1), (0, 0, half, half), (0, 0, 0, 2)], "f4"),
        SCALE=draft.array([(1, 1, 1), (1, 1, 1), (2, 2, 2)], "f4"),
    )
    scene = load_gltf(path)
    assert scene.warnings == ()
    first, second, third = scene.meshes
    assert first.geometry is second.geometry
    np.testing.assert_allclose(first.world_from_object[:3, 3], (1, 0, 7))
    np.testing.assert_allclose(second.world_from_object[:3, 0], (0, 1, 0), atol=1e-6)
    np.testing.assert_allclose(third.world_from_object[:3, :3], 2 * np.eye(3))


def test_instances_move_with_their_node(draft):
    shift = draft.array([(1, 0, 0), (0, 5, 0)], "f4")
    times = draft.array([0.0, 1.0], "f4")
    there = draft.array([(0, 0, 0), (0, 0, 4)], "f4")
    draft.json["animations"] = [
        {
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            "samplers": [{"input": times, "output": there}],
        }
    ]
    moved = load_gltf(instanced(draft, TRANSLATION=shift)).at(0.5)
    places = [mesh.world_from_object[:3, 3] for mesh in moved.meshes]
    np.testing.assert_allclose(places, [(1, 0, 2), (0, 5, 2)], atol=1e-6)


def test_bad_instances_are_one_error(draft):
    bad = {
        "TRANSLATION": draft.array([(1, 0, 0), (2, 0, 0)], "f4"),
        "SCALE": draft.array([(1, 1, 1)], "f4"),
    }
    with pytest.raises(SceneError, match=r"its attributes have \[1, 2\] values"):
        load_gltf(instanced(draft, **bad))
    draft.json["accessors"].append({"componentType": 5126, "count": 10**8, "type": "VEC3"})
    with pytest.raises(SceneError, match="more than 100000 instances"):
        load_gltf(instanced(draft, TRANSLATION=len(draft.json["accessors"]) - 1))


def test_parts_of_material_extensions_and_light_ranges_are_named(draft):
    primitive = draft.triangle()
    primitive["material"] = 0
    draft.single(primitive, extensions={"KHR_lights_punctual": {"light": 0}})
    specular = {"specularFactor": 0.5, "specularColorFactor": [1, 0, 0]}
    draft.json["materials"] = [{"extensions": {"KHR_materials_specular": specular}}]
    lights = [{"type": "point", "intensity": 4, "range": 3}]
    draft.json["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    told = " ".join(load_gltf(draft.gltf()).warnings)
    assert "specularColorFactor of KHR_materials_specular left out" in told
    assert "its range is left out" in told


def test_an_image_that_only_basisu_has_is_asked_for(draft, monkeypatch):
    primitive = draft.triangle(TEXCOORD_0=draft.array([(0, 0), (1, 0), (0, 1)], "f4"))
    primitive["material"] = 0
    draft.single(primitive)
    draft.json["images"] = [{"uri": "a.ktx2"}]
    draft.json["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
    draft.json["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    draft.json["extensionsUsed"] = ["KHR_texture_basisu"]
    told = " ".join(load_gltf(draft.gltf()).warnings)
    assert "images[0] (a.ktx2): file not found; a magenta checker stands in" in told
    # What is missing to read one is said with how to get it.
    monkeypatch.setattr(ktx2, "has_transcoder", lambda: False)
    written = draft.gltf()
    header = struct.pack("<9I", 0, 1, 8, 8, 0, 0, 1, 1, 0)
    (written.parent / "a.ktx2").write_bytes(ktx2.IDENTIFIER + header + bytes(99))
    told = " ".join(load_gltf(written).warnings)
    assert "opengl-basisu; a magenta checker stands in. Run: pip install 'airlight[gltf]'" in told


def test_the_warnings_are_in_json_too(draft, capsys):
    path = lit(draft, extensionsUsed=["ACME_unheard_of"]).gltf()
    assert run(["validate", str(path), "--json"]) == 0
    assert "ACME_unheard_of" in json.loads(capsys.readouterr().out)["warnings"][0]
