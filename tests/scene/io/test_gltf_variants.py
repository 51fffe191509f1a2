"""KHR_materials_variants: looks of a model by name."""

from __future__ import annotations

import json

import pytest

from airlight.app import cli
from airlight.errors import SceneError
from airlight.scene.io import load, load_meshes

NAME = "KHR_materials_variants"


@pytest.fixture
def shoe(draft):
    """A file of two variants; the first primitive has a look for one, the second for none."""
    mapping = {"mappings": [{"variants": [1], "material": 1}]}
    changing = {**draft.triangle(), "material": 0, "extensions": {NAME: mapping}}
    draft.single(changing)
    draft.json["meshes"][0]["primitives"].append({**draft.triangle(), "material": 2})
    draft.json["materials"] = [{"name": name} for name in ("white", "blue", "sole")]
    draft.json["extensions"] = {NAME: {"variants": [{"name": "beach"}, {"name": "street"}]}}
    draft.json["extensionsUsed"] = [NAME]
    return draft.glb()


def worn(scene) -> list[str]:
    return [mesh.material.name for mesh in scene.meshes]


def test_each_primitive_wears_what_the_variant_maps_or_its_own(shoe):
    assert worn(load_meshes(shoe)) == ["white", "sole"]
    assert worn(load_meshes(shoe, "beach")) == ["white", "sole"]
    assert worn(load_meshes(shoe, "street")) == ["blue", "sole"]
    assert load_meshes(shoe).warnings == ()


def test_a_scene_file_and_an_option_choose_one(shoe):
    scene_file = shoe.with_suffix(".toml")
    scene_file.write_text(f'[[mesh]]\nfile = "{shoe.name}"\nvariant = "street"\n')
    assert worn(load(scene_file)) == worn(load(shoe, variant="street")) == ["blue", "sole"]


def test_an_unknown_one_names_those_there_are(shoe, draft, tmp_path):
    with pytest.raises(SceneError, match="no material variant 'steet', but 'beach', 'street'"):
        load(shoe, variant="steet")
    del draft.json["extensions"]
    with pytest.raises(SceneError, match="no material variant 'street': it has none"):
        load(draft.glb(), variant="street")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.raises(SceneError, match="only glTF files have variants"):
        load(tmp_path / "a.obj", variant="street")


def test_info_lists_them_and_convert_keeps_the_choice(shoe, tmp_path, capsys):
    assert cli.run(["info", str(shoe), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["variants"] == ["beach", "street"]
    out = tmp_path / "shoe.toml"
    words = ["convert", str(shoe), str(out), "--variant", "street", "--up", "z", "--scale", "0.5"]
    assert cli.run(words) == 0
    assert cli.run(["convert", str(out), str(tmp_path / "again.toml")]) == 0
    back, asked = load(tmp_path / "again.toml"), load(shoe, variant="street", up="z", scale=0.5)
    assert worn(back) == ["blue", "sole"]
    assert [m.world_from_object.tolist() for m in back.meshes] == [
        m.world_from_object.tolist() for m in asked.meshes
    ]


def test_options_of_models_are_refused_elsewhere(tmp_path, capsys):
    assert cli.run(["info", "builtin:cornell", "--up", "z"]) == 2
    assert (
        "builtin:cornell: up is for mesh files and density grids (.obj, " in capsys.readouterr().err
    )
