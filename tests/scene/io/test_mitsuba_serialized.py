"""Mitsuba's .serialized meshes, written here by their description; Mitsuba reads the same."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.mitsuba import load_mitsuba
from airlight.scene.io.mitsuba_serialized import read_serialized

POSITIONS = np.array([(0, 0, 0), (2, 0, 0), (0, 3, 0), (2, 3, 1)], np.float32)
INDICES = np.array([(0, 1, 2), (1, 3, 2)], np.uint32)
UVS = np.array([(0, 0), (1, 0), (0, 1), (1, 0.75)], np.float32)
NORMALS = np.array([(0, 0, 1), (0, 0.6, 0.8), (0, 0, 1), (0.6, 0, 0.8)], np.float32)


def stream(version: int, *, shift: float = 0.0, is_double: bool = False) -> bytes:
    real = "<f8" if is_double else "<f4"
    body = struct.pack("<I", 0x0003 | (0x2000 if is_double else 0x1000))
    if version == 4:
        body += b"a mesh\0"
    body += struct.pack("<QQ", len(POSITIONS), len(INDICES))
    for values in (POSITIONS + np.float32(shift), NORMALS, UVS):
        body += values.astype(real).tobytes()
    return struct.pack("<HH", 0x041C, version) + zlib.compress(body + INDICES.tobytes())


def write(path: Path, version: int, **more) -> Path:
    """Two meshes, the second one metre to every side of the first."""
    parts = [stream(version, **more), stream(version, shift=1.0, **more)]
    offsets = struct.pack("<QQ" if version == 4 else "<II", 0, len(parts[0]))
    path.write_bytes(b"".join(parts) + offsets + struct.pack("<I", 2))
    return path


@pytest.mark.parametrize("is_double", [False, True])
@pytest.mark.parametrize("version", [3, 4])
def test_every_mesh_of_a_file(tmp_path, version, is_double):
    path = write(tmp_path / "two.serialized", version, is_double=is_double)
    for index in (0, 1):
        mesh = read_serialized(path, index)
        np.testing.assert_array_equal(mesh.positions, POSITIONS + index)
        np.testing.assert_array_equal(mesh.indices, INDICES)
        np.testing.assert_array_equal(mesh.uvs, UVS)
        np.testing.assert_allclose(mesh.normals, NORMALS, rtol=1e-6)


def scene_file(folder: Path) -> Path:
    write(folder / "two.serialized", 4)
    path = folder / "scene.xml"
    path.write_text(
        '<scene version="3.0.0"><shape type="serialized"><string name="filename" '
        'value="two.serialized"/><integer name="shape_index" value="1"/></shape></scene>'
    )
    return path


def test_a_scene_takes_the_mesh_that_it_names(tmp_path):
    (mesh,) = load_mitsuba(scene_file(tmp_path)).meshes
    np.testing.assert_array_equal(mesh.geometry.positions, POSITIONS + 1)


@pytest.mark.needs("mitsuba")
def test_mitsuba_reads_the_same(tmp_path):
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    path = write(tmp_path / "two.serialized", 4)
    theirs = mi.load_dict({"type": "serialized", "filename": str(path), "shape_index": 1})
    params, ours = mi.traverse(theirs), read_serialized(path, 1)
    for name, values in (
        ("vertex_positions", ours.positions),
        ("vertex_normals", ours.normals),
        ("vertex_texcoords", ours.uvs),
        ("faces", ours.indices),
    ):
        np.testing.assert_allclose(np.array(params[name]).reshape(values.shape), values, rtol=1e-6)


def test_damage_is_one_error_that_names_the_file(tmp_path):
    path = write(tmp_path / "two.serialized", 4)
    whole = path.read_bytes()
    with pytest.raises(SceneError, match="shape_index is 2, but the file holds 2 meshes"):
        read_serialized(path, 2)
    for end in range(0, len(whole), 5):
        path.write_bytes(whole[:end])
        with pytest.raises(SceneError, match=r"two\.serialized"):
            read_serialized(path, 1)
    middle = len(whole) // 3
    path.write_bytes(whole[:middle] + bytes(8) + whole[middle + 8 :])
    with pytest.raises(SceneError, match=r"mesh 0 of the \.serialized file is damaged"):
        read_serialized(path, 0)
