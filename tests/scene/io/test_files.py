"""Files are read whole, or the reason is said."""

from __future__ import annotations

import contextlib
import os
import socket

import pytest

from airlight.errors import SceneError
from airlight.scene.io.files import inside, naming, read_bytes, read_text


def test_reading(tmp_path):
    (tmp_path / "a").write_bytes(b"x")
    assert read_bytes(tmp_path / "a") == b"x"
    with pytest.raises(SceneError, match=r"b: file not found\. Check the path\."):
        read_bytes(tmp_path / "b")
    with pytest.raises(SceneError, match="this is a folder, not a file"):
        read_bytes(tmp_path)
    with pytest.raises(SceneError, match="cannot be read"):
        read_bytes(tmp_path / ("x" * 5000))


def test_only_regular_files_are_read(tmp_path):
    def socket_at(path):
        with socket.socket(socket.AF_UNIX) as made, contextlib.chdir(path.parent):
            made.bind(path.name)  # such names are short

    makers = {
        "a pipe": os.mkfifo,
        "a socket": socket_at,
        "a device": lambda path: path.symlink_to("/dev/zero"),
        "a folder": lambda path: path.mkdir(),
    }
    for kind, make in makers.items():
        path = tmp_path / kind.replace(" ", "-")
        make(path)
        (tmp_path / f"link-{path.name}").symlink_to(path)
        for asked in (path, tmp_path / f"link-{path.name}"):
            with pytest.raises(SceneError, match=f"this is {kind}, not a file"):
                read_bytes(asked)
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(SceneError, match=r"loop: cannot be read"):
        read_bytes(tmp_path / "loop")
    (tmp_path / "a").write_bytes(b"xyz")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    assert read_bytes(tmp_path / "link") == b"xyz"


def test_text_is_utf_8(tmp_path):
    (tmp_path / "a").write_bytes("für".encode())
    assert read_text(tmp_path / "a") == "für"
    (tmp_path / "a").write_bytes("für".encode("latin-1"))
    with pytest.raises(SceneError, match=r"is not UTF-8 text \(byte 1\)"):
        read_text(tmp_path / "a")


OUTSIDE = [
    "../a",
    "b/../../a",
    "..\\a",
    "/a",
    "\\a",
    "//host/a",
    "C:/a",
    "c:\\a",
    "c:a",
    "link/a",
    "nul",
    "CON.png",
    "textures/aux.jpg",
    "com1",
    "lpt9.obj",
    "loop",
    "a\0b",
]


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_file_names_no_other_outside_its_folder(tmp_path, name):
    root = tmp_path / "root"
    (root / "b").mkdir(parents=True)
    (tmp_path / "a").touch()
    (root / "link").symlink_to(tmp_path)
    (root / "loop").symlink_to(root / "loop")
    with pytest.raises(SceneError, match="it names '"):
        inside(root, name, "scene.gltf")


def test_a_link_out_of_the_folder_is_called_one(tmp_path):
    root = tmp_path / "root"
    root.mkdir()
    (root / "a.bin").symlink_to(tmp_path / "store.bin")
    with pytest.raises(SceneError) as caught:
        inside(root, "a.bin", "scene.gltf")
    store = tmp_path.resolve() / "store.bin"
    assert str(caught.value) == (
        f"scene.gltf: it names 'a.bin', a link to '{store}', which is outside its folder. "
        "Copy the file beside it."
    )


@pytest.mark.parametrize("name", ["a", "b/a", "b\\a", "./a", "b/../a", "console", "..a", "ab:c"])
def test_a_file_names_others_in_its_folder(tmp_path, name):
    assert inside(tmp_path, name, "").is_relative_to(tmp_path.resolve())


def test_what_a_parser_raises_names_the_file(tmp_path):
    for raised in (ValueError("x"), KeyError("x"), OverflowError("x"), RecursionError("x")):
        with pytest.raises(SceneError, match=r"^a\.glb: is damaged, or") as caught, naming("a.glb"):
            raise raised
        assert caught.value.__cause__ is raised
    with pytest.raises(SceneError, match=r"^a\.glb: bad\. Mend it\.$"), naming("a.glb"):
        raise SceneError("bad", remedy="Mend it.")
    with pytest.raises(SceneError, match=r"^b\.png: bad$"), naming("a.glb"):
        raise SceneError("bad", where="b.png")
    with pytest.raises(AttributeError), naming("a.glb"):  # a mistake of ours stays one
        raise AttributeError
