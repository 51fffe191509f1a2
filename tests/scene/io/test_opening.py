"""Inputs that are no regular files, and files that name others elsewhere: every reader refuses."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from urllib.parse import quote

import numpy as np
import PIL.Image
import pytest

from airlight import load
from airlight.errors import SceneError
from airlight.exports.light_field_file import load_light_field
from airlight.scene.fingerprint import fingerprint
from airlight.scene.io import SCENE_SUFFIXES
from airlight.scene.io.images import IMAGE_SUFFIXES, load_image, read_radiance

QUAD = '[[mesh]]\nshape = "quad"\n'
BY_TOML = {
    "mesh.obj": '[[mesh]]\nfile = "{}"\n',
    "grid.npy": '[[volume]]\nfile = "{}"\nsigma_t = 1\n',
    "sky.exr": QUAD + '[environment]\nfile = "{}"\n',
    "lights.npz": QUAD + '[[light]]\ntype = "points"\nfile = "{}"\n',
}
SPECIAL: dict[str, Callable[[Path], object]] = {
    "a pipe": os.mkfifo,
    "a device": lambda path: path.symlink_to("/dev/zero"),
    "a folder": lambda path: path.mkdir(),
}


@pytest.fixture(params=SPECIAL)
def special(request) -> tuple[str, Callable[[Path], object]]:
    """What an input may be instead of a file, and what makes one."""
    return request.param, SPECIAL[request.param]


@pytest.mark.parametrize("suffix", SCENE_SUFFIXES)
def test_scenes(tmp_path, special, suffix):
    kind, make = special
    path = tmp_path / f"a{suffix}"
    make(path)
    if kind == "a folder" and suffix == ".zarr":
        pytest.skip("a zarr store is a folder")
    with pytest.raises(SceneError) as caught:
        load(path)
    assert str(caught.value) == f"{path}: this is {kind}, not a file"


@pytest.mark.parametrize("name", BY_TOML)
def test_what_a_scene_file_names(tmp_path, special, name):
    kind, make = special
    make(tmp_path / name)
    (tmp_path / "a.toml").write_text(BY_TOML[name].format(name))
    with pytest.raises(SceneError, match=f"file '{name}' is {kind}, not a file"):
        load(tmp_path / "a.toml")


def test_what_other_files_name_is_left_out_with_a_warning(tmp_path, special):
    _, make = special
    make(tmp_path / "a.png")
    (tmp_path / "a.mtl").write_text("newmtl m\nmap_Kd a.png\n")
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert "a magenta checker stands in" in load(tmp_path / "a.obj").warnings[0]
    make(tmp_path / "b.mtl")
    (tmp_path / "b.obj").write_text("mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert "b.mtl" in load(tmp_path / "b.obj").warnings[0]


def test_images_light_fields_and_fingerprints(tmp_path, special):
    kind, make = special
    for suffix in IMAGE_SUFFIXES:
        make(tmp_path / f"a{suffix}")
        for read in (load_image, read_radiance, fingerprint):
            with pytest.raises(SceneError, match=f"this is {kind}, not a file"):
                read(tmp_path / f"a{suffix}")
    make(tmp_path / "a.npz")
    if kind != "a folder":  # which is a form of light fields
        with pytest.raises(SceneError, match=f"this is {kind}, not a file"):
            load_light_field(tmp_path / "a.npz")


LONG = "a" * 300


@pytest.mark.parametrize("suffix", ["", *SCENE_SUFFIXES])
def test_names_that_no_file_system_takes(tmp_path, suffix):
    with pytest.raises(SceneError, match="cannot be read"):
        load(tmp_path / f"{LONG}{suffix}")


@pytest.mark.parametrize("name", BY_TOML)
def test_names_in_scene_files_that_no_file_system_takes(tmp_path, name):
    (tmp_path / "a.toml").write_text(BY_TOML[name].format(LONG + name))
    with pytest.raises(SceneError, match="cannot be read"):
        load(tmp_path / "a.toml")


def test_a_sequence_of_a_name_that_no_file_system_takes(tmp_path):
    (tmp_path / "a.toml").write_text(f'[[volume]]\nsigma_t = 1\nsequence = "{LONG}*.npy"\n')
    with pytest.raises(SceneError, match="names no files"):
        load(tmp_path / "a.toml")


def test_a_grid_in_xml_of_a_name_that_no_file_system_takes(tmp_path):
    (tmp_path / "a.xml").write_text(
        '<scene version="3.0.0"><shape type="cube"><medium type="heterogeneous" name="interior">'
        f'<volume type="gridvolume" name="sigma_t"><string name="filename" value="{LONG}.vol"/>'
        "</volume></medium></shape></scene>"
    )
    with pytest.raises(SceneError, match="cannot be read"):
        load(tmp_path / "a.xml")


@pytest.mark.parametrize("suffix", SCENE_SUFFIXES)
def test_a_link_to_itself(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    path.symlink_to(path)
    with pytest.raises(SceneError, match="cannot be read"):
        load(path)


def _elsewhere(tmp_path: Path) -> dict[str, str]:
    """URIs of a file outside the folder `inner`, as attackers write them."""
    secret = tmp_path / "secret"
    return {
        "above": "../secret",
        "quoted": "..%2fsecret",
        "quoted dots": "%2e%2e/secret",
        "backslash": "..\\secret",
        "absolute": str(secret),
        "quoted absolute": quote(str(secret), safe=""),
        "scheme": f"file://{secret}",
        "scheme alone": f"file:{secret}",
        "web": "https://example.org/a.bin",
        "link": "link",
        "drive": "C:/secret",
        "device": "NUL",
        "device with an ending": "con.bin",
    }


@pytest.mark.parametrize("way", _elsewhere(Path()))
@pytest.mark.parametrize("what", ["buffer", "image"])
def test_gltf_reads_nothing_outside_its_folder(tmp_path, bent_triangle, way, what):
    (tmp_path / "inner").mkdir()
    PIL.Image.fromarray(np.zeros((32, 32, 3), np.uint8)).save(tmp_path / "secret", "PNG")
    (tmp_path / "inner" / "link").symlink_to(tmp_path / "secret")
    uri = _elsewhere(tmp_path)[way]

    def bend(document):
        if what == "buffer":
            document["buffers"] = [{"byteLength": 8, "uri": uri}]
            return
        document["images"] = [{"uri": uri}]
        document["textures"] = [{"source": 0}]
        document["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
        document["meshes"][0]["primitives"][0]["material"] = 0

    path = tmp_path / "inner" / "a.gltf"
    path.write_text(bent_triangle(bend).read_text())
    with pytest.raises(SceneError) as caught:
        load(path)
    expected = {"web": "not a file beside", "scheme": "not a file beside", "device": "a device"}
    assert expected.get(way.split()[0], "outside its folder") in str(caught.value)
    assert str(caught.value).startswith(f"{path}: {what}s[0]: ")


def test_gltf_reads_what_lies_below_it(tmp_path, draft):
    primitive = draft.triangle()
    path = draft.single(primitive).gltf()
    document = json.loads(path.read_text())
    (tmp_path / "sub dir").mkdir()
    (tmp_path / "sub dir" / "a.bin").write_bytes(draft.binary)
    for uri in ("sub%20dir/a.bin", "sub dir/a.bin", "./sub%20dir/../sub%20dir/a.bin"):
        document["buffers"][0]["uri"] = uri
        path.write_text(json.dumps(document))
        assert load(path).triangle_count == 1


def test_obj_follows_relative_paths_and_no_absolute_ones(tmp_path):
    (tmp_path / "models").mkdir()
    (tmp_path / "images").mkdir()
    kept = tmp_path / "images" / "x.png"
    PIL.Image.fromarray(np.full((32, 32, 3), 90, np.uint8)).save(kept)
    path = tmp_path / "models" / "a.obj"
    path.write_text("mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for name in ("../images/x.png", "..\\Images\\X.png"):
        (tmp_path / "models" / "a.mtl").write_text(f"newmtl m\nmap_Kd {name}\n")
        assert not load(path).warnings
    for name in (str(kept), "C:\\images\\x.png"):
        (tmp_path / "models" / "a.mtl").write_text(f"newmtl m\nmap_Kd {name}\n")
        (warning,) = load(path).warnings
        assert warning.startswith(f"{path}: texture '{name}' is missing")
        assert "a magenta checker stands in" in warning


def test_toml_may_name_any_file(tmp_path):
    (tmp_path / "inner").mkdir()
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for name in ("../a.obj", str(tmp_path / "a.obj")):
        (tmp_path / "inner" / "a.toml").write_text(BY_TOML["mesh.obj"].format(name))
        assert load(tmp_path / "inner" / "a.toml").triangle_count == 1
