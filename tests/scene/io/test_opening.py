"""Inputs that are no regular files, and what scene files may name: one rule for every reader."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from airlight import load
from airlight.errors import SceneError
from airlight.exports.light_field_file import load_light_field
from airlight.scene.fingerprint import fingerprint
from airlight.scene.io import SCENE_SUFFIXES
from airlight.scene.io.files import confined_to
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


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
NAMING = {
    "gltf": '{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 36, "uri": "{}"}}], '
    '"bufferViews": [{{"buffer": 0, "byteLength": 36}}], "accessors": [{{"bufferView": 0, '
    '"componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}], '
    '"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], '
    '"nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}], "scene": 0}}',
    "toml": "[[mesh]]\nfile = '{}'\n",
    "xml": '<scene version="3.0.0"><shape type="obj"><string name="filename" value="{}"/></shape>'
    "</scene>",
    "usda": '#usda 1.0\ndef "A" (prepend references = @{}@)\n{{\n}}\n',
}
NAMED = {
    "gltf": np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes(),
    "toml": TRIANGLE.encode(),
    "xml": TRIANGLE.encode(),
    "usda": b'#usda 1.0\n(\n    defaultPrim = "Q"\n)\ndef Mesh "Q"\n{\n'
    b"int[] faceVertexCounts = [3]\n"
    b"int[] faceVertexIndices = [0, 1, 2]\npoint3f[] points = [(0,0,0), (1,0,0), (0,1,0)]\n}\n",
}
ENDINGS = {"gltf": "bin", "toml": "obj", "xml": "obj", "usda": "usda"}


@pytest.fixture(
    params=["gltf", "toml", "xml", pytest.param("usda", marks=pytest.mark.needs("usd_core")), "obj"]
)
def names(request, tmp_path) -> Callable[[str], str]:
    """Writes a scene into `inner` that names a file, loads it, and says what was wrong, if it was.

    {} in the name stands for a file above `inner`, without its folder.
    """
    kind = request.param
    (tmp_path / "inner").mkdir()
    file = f"target.{ENDINGS.get(kind, 'png')}"
    if kind == "obj":
        PIL.Image.fromarray(np.full((32, 32, 3), 90, np.uint8)).save(tmp_path / file)
    else:
        (tmp_path / file).write_bytes(NAMED[kind])
    (tmp_path / "inner" / f"link-{file}").symlink_to(tmp_path / file)

    def said(name: str) -> str:
        written = name.format(file)
        path = tmp_path / "inner" / f"a{len(list((tmp_path / 'inner').iterdir()))}.{kind}"
        if kind == "obj":
            path.with_suffix(".mtl").write_text(f"newmtl m\nmap_Kd {written}\n")
            path.write_text(f"mtllib {path.stem}.mtl\nusemtl m\n{TRIANGLE}")
        else:
            text = written.replace("\\", "\\\\") if kind == "gltf" else written
            path.write_text(NAMING[kind].format(text))
        try:
            loaded = load(path)
        except SceneError as error:
            return str(error)
        assert loaded.triangle_count == 1
        return " ".join(text for text in loaded.warnings if "texture" in text or "target" in text)

    return said


def test_every_scene_file_may_name_files_above_it(names, tmp_path, monkeypatch):
    paths = ["../{}", "link-{}", f"{tmp_path.as_posix()}/{{}}", "../inner/../{}"]
    if not (tmp_path / "target.usda").exists():  # whose own resolver takes slashes alone
        paths.append("..\\{}")
    for path in paths:
        assert names(path) == "", path
    # But those out of the folder that someone sets, or that strangers' files are kept in.
    with monkeypatch.context() as bounded:
        bounded.setenv("AIRLIGHT_ROOT", str(tmp_path))
        assert all(names(path) == "" for path in paths)
        for root in ("inner", "elsewhere"):
            bounded.setenv("AIRLIGHT_ROOT", str(tmp_path / root))
            for path in paths:
                assert re.search("outside of|is missing", names(path)), (root, path)
    with confined_to(tmp_path / "inner"):
        for path in paths:
            assert re.search("outside of|is missing", names(path)), path
        with confined_to(tmp_path):  # the innermost holds
            assert names(paths[0])
    assert names(paths[0]) == ""


@pytest.mark.parametrize(
    "path",
    [
        *(
            "//host/share/{}",
            "\\\\host\\share\\{}",
            "C:/x/{}",
            "NUL",
            "con.{}",
            "fifo-{}",
            "zero-{}",
        ),
        *("/proc/self/environ", "../../../../../../../../../proc/kmsg", "/sys/kernel/profiling"),
    ],
)
def test_no_scene_file_may_name_what_no_scene_needs(names, tmp_path, path, request):
    """Shares of other machines, devices, pipes, files that the system makes up."""
    file = next(path.name for path in tmp_path.iterdir() if path.is_file())
    os.mkfifo(tmp_path / "inner" / f"fifo-{file}")
    (tmp_path / "inner" / f"zero-{file}").symlink_to("/dev/zero")
    if file.endswith("obj") and "{}" not in path:  # a mesh file by its ending
        path += ".obj"
    said = names(path)
    known = "another machine|a path of Windows|a device|a pipe|of the system|is missing|not found"
    assert re.search(known, said), path


@pytest.mark.parametrize("uri", ["https://example.org/a.bin", "file:///a.bin", "file:a.bin"])
def test_gltf_fetches_nothing(tmp_path, uri):
    (tmp_path / "a.gltf").write_text(NAMING["gltf"].format(uri))
    with pytest.raises(SceneError, match=r"buffers\[0\]: '.*' is not a file beside this one"):
        load(tmp_path / "a.gltf")


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


def test_an_obj_finds_images_of_other_cases_and_of_other_machines(tmp_path):
    for folder in ("models", "images"):
        (tmp_path / folder).mkdir()
    kept = tmp_path / "images" / "x.png"
    PIL.Image.fromarray(np.full((32, 32, 3), 90, np.uint8)).save(kept)
    path = tmp_path / "models" / "a.obj"
    path.write_text(f"mtllib a.mtl\nusemtl m\n{TRIANGLE}")
    for name in ("..\\Images\\X.png", "C:\\elsewhere\\x.png", "/elsewhere/x.png"):
        (tmp_path / "models" / "a.mtl").write_text(f"newmtl m\nmap_Kd {name}\n")
        if "elsewhere" in name:
            (warning,) = load(path).warnings
            assert warning.startswith(f"{path}: texture '{name}' is missing")
            kept.replace(tmp_path / "models" / "x.png")
            assert not load(path).warnings
            (tmp_path / "models" / "x.png").replace(kept)
        else:
            assert not load(path).warnings
