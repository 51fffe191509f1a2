"""OBJ files to meshes: one per material, all corners with normals, trimesh as the authority."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.obj import load_obj

CUBE = """# a cube of quads
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4
"""


@pytest.fixture
def load(tmp_path: Path):
    """Loads text as an OBJ file."""

    def load_text(text: str, **other: str):
        for name, content in other.items():
            (tmp_path / f"{name}.mtl").write_text(content)
        (tmp_path / "thing.obj").write_text(text)
        return load_obj(tmp_path / "thing.obj")

    return load_text


def surface_area(scene) -> float:
    total = 0.0
    for mesh in scene.meshes:
        a, b, c = mesh.geometry.positions[mesh.geometry.indices].transpose(1, 0, 2)
        total += float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
    return total


def test_quads_become_two_triangles_each_and_a_box_keeps_its_edges(load):
    scene = load(CUBE)
    geometry = scene.meshes[0].geometry
    assert len(geometry.indices) == 12
    assert surface_area(scene) == pytest.approx(6.0)
    a, b, c = geometry.positions[geometry.indices].transpose(1, 0, 2)
    faces = np.cross(b - a, c - a)
    corner_normals = geometry.normals[geometry.indices]
    np.testing.assert_allclose(corner_normals, np.repeat(faces[:, None], 3, axis=1), atol=1e-6)
    # 24 corners of six flat sides, no more.
    assert len(geometry.positions) == 24


def test_a_round_thing_is_smooth_and_s_off_makes_it_flat(load):
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = "".join(f"v {np.cos(a):.6f} {y} {np.sin(a):.6f}\n" for y in (0, 1) for a in angle)
    faces = "".join(
        f"f {k + 1} {k + 25} {(k + 1) % 24 + 25} {(k + 1) % 24 + 1}\n" for k in range(24)
    )
    smooth = load(ring + faces).meshes[0].geometry
    radial = smooth.positions * (1, 0, 1)
    np.testing.assert_allclose(smooth.normals, radial, atol=1e-3)
    assert len(smooth.positions) == 48
    flat = load(ring + "s off\n" + faces).meshes[0].geometry
    assert len(flat.positions) == 4 * 24


def test_a_large_polygon_is_a_fan(load):
    angle = np.linspace(0, 2 * np.pi, 7, endpoint=False)
    text = "".join(f"v {np.cos(a)} {np.sin(a)} 0\n" for a in angle) + "f 1 2 3 4 5 6 7\n"
    scene = load(text)
    assert scene.triangle_count == 5
    assert surface_area(scene) == pytest.approx(3.5 * np.sin(2 * np.pi / 7))


def test_every_way_to_write_a_corner_and_v_turned_down(load):
    head = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0.25\nvt 0 1\nvn 0 0 2\n"
    for corner in ("1/1/1 2/2/1 3/3/1", "-3/-3/-1 -2/-2/-1 -1/-1/-1"):
        geometry = load(head + f"f {corner}\n").meshes[0].geometry
        order = geometry.indices[0]
        np.testing.assert_allclose(geometry.uvs[order], [[0, 1], [1, 0.75], [0, 0]])
        np.testing.assert_allclose(geometry.normals, [[0, 0, 1]] * 3)
    assert load(head + "f 1//1 2//1 3//1\n").meshes[0].geometry.uvs is None
    mixed = load(head + "f 1/1 2/2 3/3\nf 1 2 3\nf 1//1 2//1 3//1\nf 1/1/ 2/2/ 3/3/\n")
    assert mixed.triangle_count == 4


def test_negative_indices_count_from_their_own_line(load):
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf -3 -2 -1\n"
    positions = load(text).meshes[0].geometry.positions
    assert sorted(positions[:, 2].tolist()) == [0, 0, 0, 5, 5, 5]


def test_one_mesh_per_material_in_use(load):
    text = (
        "mtllib my.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
        "usemtl red\nf 1 2 3\nusemtl unused\nusemtl blue one\nf 1 2 4\nusemtl red\nf 2 3 4\n"
    )
    scene = load(text, my="newmtl red\nKd 1 0 0\nnewmtl blue one\nKd 0 0 1\n")
    assert [(m.name, len(m.geometry.indices)) for m in scene.meshes] == [
        ("red", 2),
        ("blue one", 1),
    ]
    assert scene.meshes[1].material.base_color == (0, 0, 1)
    assert len(scene.meshes[1].geometry.positions) == 3
    assert scene.warnings == ()


def test_missing_materials_are_grey_and_said(load):
    scene = load("mtllib no.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wood\nf 1 2 3\n")
    assert len(scene.warnings) == 2
    assert "material file 'no.mtl' is missing" in scene.warnings[0]
    assert "material 'wood' is not defined" in scene.warnings[1]


def test_vertex_colours_are_srgb(load):
    text = "v 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 0 1 0 1 0.5 0\nf 1 2 3\n"
    colors = load(text).meshes[0].geometry.colors
    np.testing.assert_allclose(colors[0], [1, 0.21404, 0, 1], atol=1e-4)


def test_windows_lines_comments_tabs_and_continuations(load):
    text = "v 0\t0 0 # one\r\n  v 1 0 0\r\nv 0 1 0\r\nf 1 2 \\\r\n3 # face\r\n"
    assert load(text).triangle_count == 1


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        (
            "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 9\n",
            5,
            "'v' index 9 is out of range: the file has",
        ),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", 4, "'v' index -4 is out of range"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", 4, "'v' index 0 is out of range"),
        ("vt 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/7 2/7 3/7\n", 5, "'vt' index 7 is out of range"),
        ("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", 2, "NaN or infinite"),
        ("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n", 2, "NaN or infinite"),
        ("v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n", 2, "'v 1 x 0' is not a list of numbers"),
        ("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", 2, "has 2 numbers, not 3"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 b\n", 4, "'f 1 2 b' is not a list of numbers"),
    ],
)
def test_errors_name_file_and_line(load, text, line, problem):
    with pytest.raises(SceneError) as error:
        load(text)
    assert problem in str(error.value)
    assert f"thing.obj, line {line}: " in str(error.value)


@pytest.mark.parametrize("text", ["", "v 0 0 0\n", "hello\nworld\n", "v 0 0 0\nv 1 0 0\nf 1 2\n"])
def test_no_triangles(load, text):
    with pytest.raises(SceneError, match=r"thing\.obj: it has no triangles"):
        load(text)


def test_missing_file(tmp_path):
    with pytest.raises(SceneError, match="file not found"):
        load_obj(tmp_path / "none.obj")


def test_the_living_room_against_trimesh(shared_data):
    import trimesh

    path = shared_data / "living_room" / "living_room.obj"
    ours = load_obj(path)
    theirs = trimesh.load(path, process=False, group_material=True, skip_materials=True)
    assert ours.triangle_count == 28656
    assert len(ours.meshes) == 41
    area = theirs.area if hasattr(theirs, "area") else sum(g.area for g in theirs.geometry.values())
    assert surface_area(ours) == pytest.approx(float(area), rel=1e-4)
    np.testing.assert_allclose(np.stack(ours.bounds), theirs.bounds, atol=1e-5)
    floor = next(m for m in ours.meshes if m.name == "Floor")
    assert floor.material.base_color_texture.pixels.shape == (910, 2048, 4)
    for mesh in ours.meshes:
        np.testing.assert_allclose(np.linalg.norm(mesh.geometry.normals, axis=1), 1, atol=1e-5)


def test_statements_that_are_not_read_are_named(tmp_path):
    path = tmp_path / "a.obj"
    shape = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    path.write_text(shape + "o a\ng b\ns 1\nusemtl c\n# no line\nlod 1\n")
    assert not any("statements" in line for line in load_obj(path).warnings)
    path.write_text(shape + "l 1 2\np 1\ncurv 0 1 1 2\n")
    assert "its statements 'p', 'l', 'curv' are not read" in load_obj(path).warnings[0]


@pytest.mark.parametrize("codec", ["utf-16-le", "utf-16-be"])
def test_utf_16_is_read_where_its_mark_says_so(tmp_path, codec):
    text = "\ufeffmtllib ä.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"
    (tmp_path / "a.obj").write_bytes(text.encode(codec))
    (tmp_path / "ä.mtl").write_bytes("\ufeffnewmtl red\nKd 1 0 0\n".encode(codec))
    (mesh,) = load_obj(tmp_path / "a.obj").meshes
    assert len(mesh.geometry.indices) == 1
    assert mesh.material.base_color[1] == 0.0


def test_faces_that_name_what_the_file_lacks_go_without(tmp_path):
    """As exporters write that drop normals and coordinates, and leave their indices."""
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    path, plain = tmp_path / "named.obj", tmp_path / "plain.obj"
    path.write_text(corners + "f 1/1/1 2/2/1 3/3/1\n")
    plain.write_text(corners + "f 1 2 3\n")
    scene, expected = load_obj(path), load_obj(plain)
    assert scene.warnings == tuple(
        f"{path}: its faces name '{name}' indices, and it has no '{name}': they go without"
        for name in ("vt", "vn")
    )
    found, other = (s.meshes[0].geometry for s in (scene, expected))
    np.testing.assert_array_equal(found.normals, other.normals)
    assert found.uvs is None
