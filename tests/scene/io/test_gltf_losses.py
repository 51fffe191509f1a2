"""What a glTF file asks for and does not get is a warning that names it."""

from __future__ import annotations

from typing import Any

import pytest

from airlight.scene.io.gltf import load_gltf


def _said(draft: Any, **more: Any) -> str:
    draft.single(draft.triangle())
    draft.json.update(more)
    return "\n".join(load_gltf(draft.glb()).warnings)


def test_a_plain_file_gets_all_it_asks_for(draft: Any) -> None:
    one = {"scenes": [{"nodes": [0]}], "samplers": [{"magFilter": 9729}]}
    assert _said(draft, **one, extras={"extensions": {"VENDOR_note": {}}}) == ""


@pytest.mark.parametrize("listed", [True, False])
@pytest.mark.parametrize("place", ["root", "node", "material", "primitive"])
def test_extensions_listed_or_not(draft: Any, place: str, listed: bool) -> None:
    draft.single(draft.triangle())
    primitive = draft.json["meshes"][0]["primitives"][0]
    draft.json["materials"] = [{}]
    primitive["material"] = 0
    held = {"root": draft.json, "node": draft.json["nodes"][0]}
    held |= {"material": draft.json["materials"][0], "primitive": primitive}
    held[place]["extensions"] = {"VENDOR_glow": {}}
    if listed:
        draft.json["extensionsUsed"] = ["VENDOR_glow"]
    said = [text for text in load_gltf(draft.glb()).warnings if "VENDOR_glow" in text]
    assert len(said) == 1 and "is not read" in said[0]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"scenes": [{"nodes": [0]}, {"name": "b", "nodes": [0]}], "scene": 1}, "'b' is shown"),
        ({"samplers": [{"magFilter": 9728}]}, "magFilter NEAREST"),
        (
            {"animations": [{"name": "run", "channels": []}, {"channels": []}]},
            "2 animations: 'run' plays",
        ),
    ],
)
def test_of_several_the_one_shown_is_named(draft: Any, more: Any, words: str) -> None:
    assert words in _said(draft, **more)


def test_colours_of_morph_targets_are_left_out(draft: Any) -> None:
    draft.single(draft.triangle())
    primitive = draft.json["meshes"][0]["primitives"][0]
    position = primitive["attributes"]["POSITION"]
    primitive["targets"] = [{"POSITION": position, "COLOR_0": position}]
    assert "morph targets of COLOR_0 are left out" in "\n".join(load_gltf(draft.glb()).warnings)
