"""Placing a mesh file: its lights and camera move along, its colours can be replaced."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import (
    Camera,
    DirectionalLight,
    Geometry,
    Material,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    Texture,
)
from airlight.scene.io import load, toml_meshes
from airlight.scene.io.toml_meshes import placed_mesh, rotation_xyz, world_from_mesh
from airlight.scene.material import SIDES
from airlight.scene.shapes import quad


@pytest.fixture
def from_file(monkeypatch, tmp_path):
    """Places a scene as though a mesh file held it."""
    (tmp_path / "x.obj").write_text("")

    def place(scene: Scene, **values) -> Scene:
        monkeypatch.setattr(toml_meshes, "_read", lambda *_: scene)
        return placed_mesh({"file": "x.obj", **values}, "[[mesh]] 1", tmp_path)

    return place


def test_an_obj_is_read_and_placed(tmp_path: Path):
    (tmp_path / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    scene = placed_mesh({"file": "t.obj", "translate": (0, 0, 5)}, "[[mesh]] 1", tmp_path)
    (mesh,) = scene.meshes
    low, high = mesh.world_bounds
    np.testing.assert_array_equal([low, high], [[0, 0, 5], [1, 1, 5]])


@pytest.mark.parametrize(
    ("angles_deg", "start", "end"),
    [
        ((90, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 90, 0), (0, 0, 1), (1, 0, 0)),
        ((0, 0, 90), (1, 0, 0), (0, 1, 0)),
    ],
)
def test_rotation_is_right_handed(angles_deg, start, end):
    np.testing.assert_allclose(rotation_xyz(angles_deg) @ start, end, atol=1e-15)


def test_rotation_is_orthonormal():
    matrix = rotation_xyz((12.0, -77.0, 201.0))
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(matrix) == pytest.approx(1.0)


def test_scale_is_innermost_and_translation_outermost():
    matrix = world_from_mesh(
        {"scale": (2.0, 3.0, 4.0), "rotate_deg": (0, 0, 90), "translate": (10, 0, 0)}, "m"
    )
    np.testing.assert_allclose(matrix @ [1, 0, 0, 1], [10, 2, 0, 1], atol=1e-14)
    np.testing.assert_allclose(matrix @ [0, 1, 0, 1], [7, 0, 0, 1], atol=1e-14)


def test_lights_and_camera_move_with_their_file(from_file):
    lights = (
        PointLight((0, 0, 1), 1.0),
        SpotLight((0, 0, 2), (0, 0, -1), 1.0),
        DirectionalLight((0, 0, -1), 1.0),
    )
    camera = Camera(position=(0, 0, 5), target=(0, 0, 0))
    scene = from_file(
        Scene(lights=lights, camera=camera),
        rotate_deg=(0, 90, 0),
        translate=(0, 1, 0),
        scale=(2,) * 3,
    )
    point, spot, sun = scene.lights
    np.testing.assert_allclose(point.position, (2, 1, 0), atol=1e-12)
    np.testing.assert_allclose(spot.position, (4, 1, 0), atol=1e-12)
    np.testing.assert_allclose([spot.direction, sun.direction], [(-1, 0, 0)] * 2, atol=1e-12)
    assert point.intensity == (1, 1, 1)
    np.testing.assert_allclose(scene.camera.position, (10, 1, 0), atol=1e-12)
    np.testing.assert_allclose(scene.camera.up, (0, 1, 0), atol=1e-12)


def test_a_file_without_camera_stays_without(from_file):
    assert from_file(Scene(), translate=(9, 9, 9)).camera == Camera()


def textured_mesh() -> Mesh:
    pixels = np.full((2, 2, 4), 64, np.uint8)
    plain = quad()
    geometry = Geometry(
        plain.positions, plain.indices, plain.normals, plain.uvs, np.full((4, 4), 0.5, np.float32)
    )
    texture = Texture(pixels)
    return Mesh(
        geometry,
        Material(
            base_color_texture=texture,
            metallic_roughness_texture=texture,
            emission_texture=texture,
            alpha_cutoff=0.5,
        ),
    )


def test_a_base_color_replaces_texture_and_vertex_colours_but_keeps_the_mask(from_file):
    mesh = from_file(Scene(meshes=(textured_mesh(),)), base_color=(1.0, 0.0, 0.0)).meshes[0]
    assert mesh.material.base_color == (1.0, 0.0, 0.0)
    pixel = mesh.material.base_color_texture.pixels[0, 0].tolist()
    assert pixel == [255, 255, 255, 64]
    assert mesh.geometry.colors[0].tolist() == [1.0, 1.0, 1.0, 0.5]
    assert mesh.material.alpha_cutoff == 0.5


def test_roughness_and_metallic_replace_their_own_channel_only(from_file):
    rough = from_file(Scene(meshes=(textured_mesh(),)), roughness=0.2).meshes[0].material
    assert rough.metallic_roughness_texture.pixels[0, 0].tolist() == [64, 255, 64, 64]
    metal = from_file(Scene(meshes=(textured_mesh(),)), metallic=0.2).meshes[0].material
    assert metal.metallic_roughness_texture.pixels[0, 0].tolist() == [64, 64, 255, 64]
    assert (rough.roughness, metal.metallic) == (0.2, 0.2)


def test_an_opacity_thins_a_cut_out_and_leaves_its_holes_where_they_are(from_file):
    own = textured_mesh()
    half = replace(own, material=replace(own.material, alpha=0.8))
    for mesh, at_one in ((own, 0.5), (half, 0.5 / 0.8)):
        material = from_file(Scene(meshes=(mesh,)), opacity=0.4).meshes[0].material
        assert (material.alpha, material.is_blended) == (0.4, True)
        # What is there at full opacity is there at this one: texels from that alpha on.
        assert material.alpha_cutoff / material.alpha == pytest.approx(at_one)


def test_emission_replaces_its_texture(from_file):
    material = from_file(Scene(meshes=(textured_mesh(),)), emission=(1, 2, 3)).meshes[0].material
    assert material.emission == (1, 2, 3)
    assert material.emission_texture is None


def test_one_material_on_many_meshes_stays_one(from_file):
    mesh = textured_mesh()
    scene = from_file(Scene(meshes=(mesh, mesh)), roughness=0.2)
    assert scene.meshes[0].material is scene.meshes[1].material


def test_without_replacements_the_file_is_untouched(from_file):
    mesh = textured_mesh()
    assert from_file(Scene(meshes=(mesh,))).meshes[0].material is mesh.material


def test_a_file_with_z_up_is_turned_before_all_else(tmp_path: Path):
    (tmp_path / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 2 3\nf 1 2 3\n")
    values = {"file": "t.obj", "up": "z", "scale": (1, 10, 1), "translate": (0, 0, 5)}
    (mesh,) = placed_mesh(values, "[[mesh]] 1", tmp_path).meshes
    # The third corner: up 3 becomes y, what lay at y = 2 lies at z = -2.
    points = mesh.geometry.positions @ mesh.world_from_object[:3, :3].T
    np.testing.assert_allclose(points[2] + mesh.world_from_object[:3, 3], (0, 30, 3), atol=1e-6)


def test_keyframes_keep_the_file_upright(tmp_path: Path):
    (tmp_path / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 3\nf 1 2 3\n")
    (tmp_path / "a.toml").write_text(
        '[[mesh]]\nfile = "t.obj"\nup = "z"\n[[mesh.key]]\ntime_s = 0\ntranslate = [0, 0, 0]\n'
        "[[mesh.key]]\ntime_s = 1\ntranslate = [7, 0, 0]\n"
    )
    scene = load(tmp_path / "a.toml")
    for time_s, left in ((0.0, 0.0), (1.0, 7.0)):
        low, high = scene.at(time_s).bounds
        np.testing.assert_allclose([low, high], [(left, 0, 0), (left + 1, 3, 0)], atol=1e-6)


def test_a_shape_has_no_variant(tmp_path: Path):
    with pytest.raises(SceneError, match="has a variant, and a shape has none"):
        placed_mesh({"shape": "box", "variant": "red"}, "[[mesh]] 1", tmp_path)


@pytest.mark.parametrize("sides", SIDES)
def test_sides_are_said_by_the_table(from_file, sides):
    for before in SIDES.values():
        quads = Scene(meshes=(Mesh(quad(), Material(roughness=0.3, **before)),))
        (mesh,) = from_file(quads, sides=sides).meshes
        found = (mesh.material.two_sided, mesh.material.has_black_back)
        assert found == tuple(SIDES[sides].values())
        assert mesh.material.roughness == 0.3
