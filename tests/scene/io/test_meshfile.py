"""PLY and STL, written by trimesh."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from airlight.errors import SceneError
from airlight.scene.io.meshfile import load_mesh_file, strip_triangles


@pytest.mark.parametrize("suffix", ["ply", "stl", "stl_ascii"])
def test_a_ball_is_smooth_and_a_box_is_not(tmp_path, suffix):
    path = tmp_path / f"a.{suffix.partition('_')[0]}"
    for shape in (trimesh.creation.icosphere(subdivisions=3), trimesh.creation.box()):
        exported = shape.export(file_type=suffix)
        path.write_bytes(exported.encode() if isinstance(exported, str) else exported)
        geometry = load_mesh_file(path).meshes[0].geometry
        assert len(geometry.indices) == len(shape.faces)
        a, b, c = geometry.positions[geometry.indices].transpose(1, 0, 2)
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        assert area == pytest.approx(shape.area, rel=1e-4)
        if len(shape.faces) > 12:
            np.testing.assert_allclose(geometry.normals, geometry.positions, atol=0.02)
            assert len(geometry.positions) == len(shape.vertices)
        else:
            assert np.abs(geometry.normals).max(axis=1).min() == pytest.approx(1)


def test_vertex_colours_are_decoded(tmp_path):
    shape = trimesh.creation.box()
    shape.visual.vertex_colors = [255, 188, 0, 255]
    shape.export(tmp_path / "a.ply")
    (mesh,) = load_mesh_file(tmp_path / "a.ply").meshes
    np.testing.assert_allclose(mesh.geometry.colors[0], [1, 0.5029, 0, 1], atol=1e-3)
    assert mesh.material.base_color == (1, 1, 1)


def test_normals_in_the_file_are_kept(tmp_path):
    shape = trimesh.creation.box()
    shape.export(tmp_path / "a.ply", vertex_normal=True)
    geometry = load_mesh_file(tmp_path / "a.ply").meshes[0].geometry
    assert len(geometry.positions) == 8
    np.testing.assert_allclose(geometry.normals, shape.vertex_normals, atol=1e-5)


PLY = """ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y
property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"""


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.ply", PLY + "0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n", "triangle index 9 is out of range"),
        ("a.ply", PLY + "0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n", "NaN or infinite"),
        ("a.ply", PLY + "0 0 0\n", ""),
        ("a.ply", PLY.replace("face 1", "face 0") + "0 0 0\n1 0 0\n0 1 0\n", "no triangles"),
        ("a.ply", "hello", "not a readable PLY file"),
        ("a.ply", "", "not a readable PLY file"),
        ("a.stl", "", "no triangles"),
        ("a.stl", "solid x\nendsolid x\n", ""),
    ],
)
def test_bad_files(tmp_path, name, content, message):
    (tmp_path / name).write_text(content)
    with pytest.raises(SceneError) as error:
        load_mesh_file(tmp_path / name)
    assert str(tmp_path / name) in str(error.value)
    assert message in str(error.value)


def test_truncated_binaries(tmp_path):
    for suffix in ("ply", "stl"):
        path = tmp_path / f"a.{suffix}"
        raw = trimesh.creation.icosphere().export(file_type=suffix)
        path.write_bytes(raw[: len(raw) // 2])
        with pytest.raises(SceneError, match=rf"a\.{suffix}: "):
            load_mesh_file(path)


def test_properties_of_a_ply_that_are_not_read_are_named(tmp_path):
    path = tmp_path / "a.ply"
    header = "ply\nformat ascii 1.0\nelement vertex 3\n"
    header += "".join(f"property float {name}\n" for name in ("x", "y", "z", "quality", "s", "t"))
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_text(header + "0 0 0 1 0 0\n1 0 0 1 1 0\n0 1 0 1 0 1\n3 0 1 2\n")
    (line,) = load_mesh_file(path).warnings
    assert "the vertex properties quality, s, t are not read" in line


def test_strips_make_every_other_triangle_turned_and_begin_again():
    strips = [np.array([0, 1, 2, 3, -1, 4, 5, 6]), np.array([7, 8, 8, 9, 10, 11]), np.array([1])]
    expected = [[0, 1, 2], [3, 2, 1], [4, 5, 6], [8, 9, 10], [11, 10, 9]]
    found = strip_triangles(strips)
    assert sorted(map(sorted, found.tolist())) == sorted(map(sorted, expected))
    np.testing.assert_array_equal(found[:3], expected[:3])
    assert strip_triangles([]).shape == (0, 3)


@pytest.mark.parametrize("is_binary", [False, True])
@pytest.mark.parametrize("has_normals", [False, True])
def test_a_ply_of_strips_is_its_triangles(tmp_path, is_binary, has_normals):
    """A square of two triangles that face +z, and one apart, as scanners' tools write them."""
    xyz = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (3, 0, 0), (4, 0, 0), (3, 1, 0)]
    strip = [0, 1, 2, 3, -1, 4, 5, 6]
    names = ["x", "y", "z"] + ["nx", "ny", "nz"] * has_normals
    rows = np.array([[*p, *((0.0, 0.0, 1.0) if has_normals else ())] for p in xyz], "<f4")
    header = "\n".join(
        [
            *("ply", f"format {'binary_little_endian' if is_binary else 'ascii'} 1.0"),
            *("element vertex 7", *(f"property float {name}" for name in names)),
            *("element tristrips 1", "property list int int vertex_indices", "end_header\n"),
        ]
    )
    if is_binary:
        data = rows.tobytes() + np.array([len(strip), *strip], "<i4").tobytes()
    else:
        lines = [" ".join(f"{x:g}" for x in row) for row in rows]
        data = "\n".join([*lines, " ".join(map(str, [len(strip), *strip])), ""]).encode()
    path = tmp_path / "strips.ply"
    path.write_bytes(header.encode() + data)
    scene = load_mesh_file(path)
    assert scene.warnings == ()
    g = scene.meshes[0].geometry
    corners = g.positions[g.indices]
    assert len(corners) == 3
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (facing[:, 2] > 0.9).all()
    np.testing.assert_allclose(g.normals, np.tile((0, 0, 1), (len(g.normals), 1)), atol=1e-4)
    # What lies outside the vertices is one sentence.
    bad = (
        data.replace(np.int32(6).tobytes(), np.int32(60).tobytes())
        if is_binary
        else data[:-2] + b"60\n"
    )
    path.write_bytes(header.encode() + bad)
    with pytest.raises(SceneError, match="strip index 60 is out of range: the file has 7"):
        load_mesh_file(path)
