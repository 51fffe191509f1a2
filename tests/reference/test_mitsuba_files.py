"""What is written is what others read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

from airlight.reference.mitsuba_files import (
    FileStore,
    write_exr,
    write_ply,
    write_png,
    write_vol,
)
from airlight.scene.io.images import read_radiance
from airlight.scene.io.mitsuba_ply import read_ply
from airlight.scene.io.volumes import read_volume
from airlight.scene.shapes import box


def test_ply(tmp_path: Path) -> None:
    geometry = box()
    colors = np.random.default_rng(0).random((24, 3), np.float32)
    path = tmp_path / "box.ply"
    write_ply(
        path,
        geometry.positions,
        geometry.indices,
        normals=geometry.normals,
        uvs=geometry.uvs,
        colors=colors,
    )
    theirs = trimesh.load(path, process=False)
    np.testing.assert_array_equal(theirs.vertices, geometry.positions)
    np.testing.assert_array_equal(theirs.faces, geometry.indices)
    ours = read_ply(path)
    for name in ("positions", "indices", "normals", "uvs"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(geometry, name))
    np.testing.assert_array_equal(ours.colors[:, :3], colors)


def test_images(tmp_path: Path) -> None:
    pixels = np.random.default_rng(0).random((3, 5, 3), np.float32) * 7
    write_exr(tmp_path / "a.exr", pixels)
    np.testing.assert_array_equal(read_radiance(tmp_path / "a.exr"), pixels)
    write_exr(tmp_path / "b.exr", pixels[..., 0])
    np.testing.assert_array_equal(read_radiance(tmp_path / "b.exr")[..., 1], pixels[..., 0])
    write_png(tmp_path / "a.png", (pixels * 30).astype(np.uint8))
    shown = np.asarray(Image.open(tmp_path / "a.png"))
    np.testing.assert_array_equal(shown, (pixels * 30).astype(np.uint8))


def test_volumes(tmp_path: Path) -> None:
    values = np.random.default_rng(0).random((2, 3, 4, 3), np.float32)
    bounds = ((0.0, -1.0, 2.0), (1.0, 3.0, 4.0))
    write_vol(tmp_path / "a.vol", values, bounds)
    for k, channel in enumerate("rgb"):
        read = read_volume(tmp_path / "a.vol", channels=channel)
        np.testing.assert_array_equal(read.density, values[..., k])
        assert read.bounds == bounds


def test_equal_content_is_written_once(tmp_path: Path) -> None:
    files = FileStore(tmp_path, "folder")
    names = [files.once(key, "a", "txt", Path.touch) for key in ("x", "y", "x")]
    assert names == ["folder/a_0000.txt", "folder/a_0001.txt", "folder/a_0000.txt"]
    assert len(list(tmp_path.iterdir())) == 2
