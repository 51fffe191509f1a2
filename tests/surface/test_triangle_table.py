"""Rows of triangles and materials."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from airlight.scene import Material, Scene
from airlight.surface.geometry import GpuScene
from airlight.surface.triangle_table import MATERIAL, WORDS

UVS = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)


def test_a_triangle_is_its_corner_and_edges(gpu, owned, square):
    mesh = square((1, 2, 3), (1, 0, 0), (0, 0.5, 0), uvs=UVS)
    seen = owned(GpuScene(gpu, Scene(meshes=(mesh,)))).triangle_table
    rows = seen.shared.triangles.read(np.float32).reshape(-1, WORDS)
    g = mesh.geometry
    corners = np.stack([rows[:, 0:3], rows[:, 0:3] + rows[:, 3:6], rows[:, 0:3] + rows[:, 6:9]], 1)
    np.testing.assert_allclose(corners, g.positions[g.indices], rtol=1e-6)
    uvs = np.stack(
        [rows[:, 9:11], rows[:, 9:11] + rows[:, 11:13], rows[:, 9:11] + rows[:, 13:15]], 1
    )
    np.testing.assert_allclose(uvs, g.uvs[g.indices], atol=1e-6)
    normals = seen.shared.triangles.read(np.int16).reshape(-1, 2 * WORDS)[:, 30:39] / 32767.0
    np.testing.assert_allclose(normals.reshape(-1, 3, 3), g.normals[g.indices], atol=2e-5)


def test_a_material_is_in_half_floats(gpu, owned, square):
    painted = Material(
        base_color=(0.5, 0.25, 1.0),
        metallic=0.75,
        roughness=0.5,
        specular=0.25,
        emission=(1e6, 2.0, 0.0),
    )
    scene = owned(GpuScene(gpu, Scene(meshes=(square((0, 0, 0), (1, 0, 0), (0, 1, 0), painted),))))
    row = scene.triangle_table.materials.read(MATERIAL)[0]
    assert row["base_color"].tolist() == [0.5, 0.25, 1.0]
    assert row["emission"].tolist() == [65504.0, 2.0, 0.0]
    assert (row["metallic"], row["roughness"], row["specular"]) == (0.75, 0.5, 0.25)


def test_coloured_vertices_are_not_shown_this_way(gpu, owned, square):
    colors = np.full((4, 4), 0.5, np.float32)
    plain = square((0, 0, 0), (1, 0, 0), (0, 1, 0))
    coloured = square((0, 0, 0), (1, 0, 0), (0, 1, 0), colors=colors)
    scene = owned(GpuScene(gpu, Scene(meshes=(plain, coloured))))
    shown = [scene.triangle_table.shows(draw.base_vertex, draw.material) for draw in scene.draws]
    assert sorted(shown) == [False, True]


def test_colours_that_come_later_are_not_shown_this_way(gpu, owned, square):
    plain = square((0, 0, 0), (1, 0, 0), (0, 1, 0))
    scene = owned(GpuScene(gpu, Scene(meshes=(plain,))))
    draw = scene.draws[0]
    assert scene.triangle_table.shows(draw.base_vertex, draw.material)
    colors = np.full((4, 4), 0.5, np.float32)
    scene.move((replace(plain, geometry=replace(plain.geometry, colors=colors)),))
    assert not scene.triangle_table.shows(draw.base_vertex, draw.material)
    scene.move((plain,))
    assert scene.triangle_table.shows(draw.base_vertex, draw.material)


def test_where_maps_lie_is_uploaded_where_it_changed(gpu, owned, square, monkeypatch):
    mesh = square((0, 0, 0), (1, 0, 0), (0, 1, 0), uvs=UVS)
    scene = owned(GpuScene(gpu, Scene(meshes=(mesh,))))
    uvs = scene.triangle_table.shared.uvs
    writes, write = [], uvs.write
    monkeypatch.setattr(uvs, "write", lambda *a: writes.append(a) or write(*a))
    for shift, uvs in ((0.1, UVS), (0.2, UVS), (0.2, UVS + np.float32(0.5))):
        positions = mesh.geometry.positions + np.float32(shift)
        geometry = replace(mesh.geometry, positions=positions, uvs=mesh.geometry.uvs)
        if uvs is not UVS:
            geometry = replace(geometry, uvs=uvs)
        scene.move((replace(mesh, geometry=geometry),))
        first = scene.triangle_table.shared.uvs.read().reshape(-1, 2)[:2]  # of the two triangles
        np.testing.assert_array_equal(first, geometry.uvs[geometry.indices[:, 0]])
    assert len(writes) == 1
