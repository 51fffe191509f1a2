"""Polygons as triangles: areas kept, whatever their shape, and never a crash."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from airlight.scene import Mesh
from airlight.scene.io import load_meshes
from airlight.scene.io.polygons import triangulated

L_SHAPE = [(4, 1), (1, 1), (1, 4), (0, 4), (0, 0), (4, 0)]  # its fan's tip is not its inner corner
ARROW = [(0, 0), (2, 1), (0, 2), (1, 1)]
SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]
COMB = [(0, 0), (9, 0), *((9 - k, 3 if k % 2 else 1) for k in range(10))]
AREAS = {"L": (L_SHAPE, 7.0), "arrow": (ARROW, 1.0), "square": (SQUARE, 4.0)}


def lifted(flat, turn: int = 0) -> np.ndarray:
    """In the plane z = 0, or one that faces another way."""
    points = np.pad(np.array(flat, np.float64), ((0, 0), (0, 1)))
    return np.roll(points, turn, axis=1) + np.array([3.0, -2.0, 5.0])


def shoelace(flat) -> float:
    x, y = np.array(flat, np.float64).T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def vector_areas(points: np.ndarray, at: np.ndarray) -> np.ndarray:
    a, b, c = points[at].transpose(1, 0, 2)
    return 0.5 * np.cross(b - a, c - a)


@pytest.mark.parametrize("turn", [0, 1, 2])
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize(
    "flat", [L_SHAPE, ARROW, SQUARE, COMB], ids=["L", "arrow", "square", "comb"]
)
def test_triangles_cover_the_polygon_once_and_face_its_way(flat, turn, backwards):
    for start in range(len(flat)):
        points = lifted([*flat[start:], *flat[:start]], turn)[:: -1 if backwards else 1]
        at, polygon = triangulated(points, np.arange(len(flat)), np.array([len(flat)]))
        assert at.shape == (len(flat) - 2, 3)
        assert (polygon == 0).all()
        areas = vector_areas(points, at)
        whole = areas.sum(axis=0)
        assert np.linalg.norm(whole) == pytest.approx(abs(shoelace(flat)))
        assert np.linalg.norm(areas, axis=1).sum() == pytest.approx(abs(shoelace(flat)))
        expected = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
        assert whole @ expected > 0.0


def test_many_of_all_sizes_keep_their_order():
    shapes = [SQUARE, L_SHAPE, [(0, 0), (1, 0), (0, 1)], ARROW, [(0, 0), (1, 1)], COMB]
    points = np.concatenate([lifted(shape) for shape in shapes])
    sizes = np.array([len(shape) for shape in shapes])
    at, polygon = triangulated(points, np.arange(len(points)), sizes)
    assert np.bincount(polygon, minlength=6).tolist() == [2, 4, 1, 2, 0, 10]
    areas = np.linalg.norm(vector_areas(points, at), axis=1)
    found = np.bincount(polygon, weights=areas, minlength=6)
    np.testing.assert_allclose(found, [abs(shoelace(shape)) for shape in shapes])
    ends = np.cumsum(sizes)
    assert (at < ends[polygon][:, None]).all()
    assert (at >= (ends - sizes)[polygon][:, None]).all()


def test_convex_polygons_are_fans():
    angle = np.linspace(0, 2 * np.pi, 9)[:-1]
    at, _ = triangulated(
        lifted(np.stack([np.cos(angle), np.sin(angle)], 1)), np.arange(8), np.array([8])
    )
    np.testing.assert_array_equal(at, [(0, k, k + 1) for k in range(1, 7)])


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((6, 3)),
        np.repeat(lifted([(0, 0), (1, 0), (2, 0)]), 2, axis=0),
        lifted([(0, 0), (2, 2), (2, 0), (0, 2)]),  # a bow tie
        lifted([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1)]),  # it touches itself
        lifted([(0, 3), (2, -3), (-3, 1), (3, 1), (-2, -3)]),  # a pentagram
        np.random.default_rng(0).normal(size=(12, 3)),
        np.random.default_rng(1).normal(size=(7, 3)) * 1e30,
        np.random.default_rng(2).normal(size=(7, 3)) * 1e-30,
    ],
    ids=["point", "line", "bow tie", "touching", "pentagram", "no plane", "huge", "tiny"],
)
def test_bad_polygons_give_as_many_triangles_of_their_own_corners(points):
    at, _ = triangulated(points, np.arange(len(points)), np.array([len(points)]))
    assert at.shape == (len(points) - 2, 3)
    assert at.min() >= 0
    assert at.max() < len(points)


def test_corners_in_line_are_left_out_without_losing_rows():
    flat = [(0, 0), (2, 0), (4, 0), (4, 4), (2, 1), (0, 4)]
    at, _ = triangulated(lifted(flat), np.arange(6), np.array([6]))
    assert at.shape == (4, 3)
    areas = np.linalg.norm(vector_areas(lifted(flat), at), axis=1)
    assert areas.sum() == pytest.approx(shoelace(flat))


def area_of(mesh: Mesh) -> float:
    points = mesh.geometry.positions.astype(np.float64)
    return float(np.linalg.norm(vector_areas(points, mesh.geometry.indices), axis=1).sum())


@pytest.mark.parametrize("name", AREAS)
def test_areas_in_obj_with_texture_coordinates_where_they_were(tmp_path: Path, name: str):
    flat, area = AREAS[name]
    lines = [f"v {x} {y} 0\nvt {x / 9} {y / 9}\nvn 0 0 1" for x, y in flat]
    face = "f " + " ".join(f"{k}/{k}/{k}" for k in range(1, len(flat) + 1))
    (tmp_path / "a.obj").write_text("\n".join([*lines, face]))
    (mesh,) = load_meshes(tmp_path / "a.obj").meshes
    assert area_of(mesh) == pytest.approx(area)
    assert mesh.geometry.uvs is not None
    expected = mesh.geometry.positions[:, :2] / 9 * (1, -1) + (0, 1)
    np.testing.assert_allclose(mesh.geometry.uvs, expected, atol=1e-6)
    np.testing.assert_allclose(mesh.geometry.normals, [(0, 0, 1)] * len(mesh.geometry.normals))


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("name", AREAS)
def test_areas_in_ply(tmp_path: Path, name: str, binary: bool):
    flat, area = AREAS[name]
    write_ply(tmp_path / "a.ply", [(x, y, 0) for x, y in flat], [list(range(len(flat)))], binary)
    (mesh,) = load_meshes(tmp_path / "a.ply").meshes
    assert area_of(mesh) == pytest.approx(area)


def test_faces_of_several_sizes_in_ply(tmp_path: Path):
    points = [(x, y, 0) for x, y in L_SHAPE]
    write_ply(tmp_path / "a.ply", points, [[0, 1, 2, 3, 4, 5], [0, 4, 5]], binary=False)
    (mesh,) = load_meshes(tmp_path / "a.ply").meshes
    assert area_of(mesh) == pytest.approx(7.0 + 2.0)


def write_ply(path: Path, points: list, faces: list, binary: bool) -> None:
    kind = "binary_little_endian" if binary else "ascii"
    header = (
        f"ply\nformat {kind} 1.0\nelement vertex {len(points)}\nproperty float x\n"
        f"property float y\nproperty float z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    if binary:
        body = b"".join(struct.pack("<3f", *point) for point in points)
        body += b"".join(struct.pack(f"<B{len(face)}i", len(face), *face) for face in faces)
    else:
        rows = [*points, *([len(face), *face] for face in faces)]
        body = "".join(" ".join(map(str, row)) + "\n" for row in rows).encode()
    path.write_bytes(header.encode() + body)
