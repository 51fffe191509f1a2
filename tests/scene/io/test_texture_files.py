"""Finding images that were named on another machine."""

from __future__ import annotations

import PIL.Image

from airlight.scene.io.texture_files import TextureFiles, missing_texture


def test_each_image_is_read_once(tmp_path):
    PIL.Image.new("RGB", (2, 2)).save(tmp_path / "a.png")
    files = TextureFiles(tmp_path / "a.obj")
    assert files.color("a.png") is files.color("a.png")
    assert files.data("a.png") is files.data("a.png")
    assert files.data("a.png").is_srgb is False
    assert files.warnings == []


def test_case_slashes_and_foreign_absolute_paths(tmp_path):
    (tmp_path / "textures").mkdir()
    target = tmp_path / "textures" / "Wood.JPG"
    PIL.Image.new("RGB", (2, 2)).save(target)
    files = TextureFiles(tmp_path / "a.obj")
    for name in ("textures/Wood.JPG", "TEXTURES\\wood.jpg", "C:\\Users\\me\\wood.jpg", "wood.jpg"):
        assert files.find(name) == target
    assert files.find("oak.jpg") is None
    assert files.find("") is None
    assert files.find("a" * 5000) is None


def test_a_broken_image_is_as_good_as_missing(tmp_path):
    (tmp_path / "a.png").write_bytes(b"\x89PNG nothing more")
    files = TextureFiles(tmp_path / "a.obj")
    assert files.color("a.png").source == "stand-in for a.png"
    assert files.data("a.png") is None
    assert len(files.warnings) == 2


def test_the_stand_in_is_seen():
    pixels = missing_texture("x").pixels
    assert {tuple(p) for p in pixels.reshape(-1, 4).tolist()} == {
        (255, 0, 255, 255),
        (20, 0, 20, 255),
    }
