"""Scenes written for Mitsuba, read back by airlight: the same scene; whole files or none."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import OutputError
from airlight.reference import mitsuba_scene
from airlight.reference.mitsuba import write_mitsuba
from airlight.reference.mitsuba_material import PRINCIPLED
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Geometry,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    Texture,
    Volume,
)
from airlight.scene.io.mitsuba import load_mitsuba
from airlight.scene.material import SIDES
from airlight.scene.shapes import box, sphere


def quad(material: Material, colors=None) -> Mesh:
    positions = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], np.float32)
    uvs = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], np.float32)
    up = np.tile(np.float32([0, 1, 0]), (4, 1))
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    return Mesh(Geometry(positions, triangles, normals=up, uvs=uvs, colors=colors), material)


def placed(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """World positions and normals."""
    m, g = mesh.world_from_object, mesh.geometry
    normals = g.normals @ np.linalg.inv(m[:3, :3])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return g.positions @ m[:3, :3].T + m[:3, 3], normals


def there_and_back(scene: Scene, folder: Path) -> tuple[Scene, list[str]]:
    notes = write_mitsuba(scene, folder / "scene.xml")
    return load_mitsuba(folder / "scene.xml"), notes


def test_geometry_and_camera_come_back(tmp_path: Path) -> None:
    turn = np.array([[0, 0, 2, 1], [0, 3, 0, 2], [-1, 0, 0, 3], [0, 0, 0, 1]], np.float64)
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    meshes = (
        Mesh(box()),
        Mesh(sphere(12, 6), world_from_object=turn),
        Mesh(box(), world_from_object=mirror),
    )
    camera = Camera(position=(1, 2, 7), target=(0.5, 1, 0), up=(0.1, 1, 0), fov_y_deg=37)
    read, _ = there_and_back(Scene(meshes=meshes, camera=camera), tmp_path)
    for before, after in zip(meshes, read.meshes, strict=True):
        for a, b in zip(placed(before), placed(after), strict=True):
            np.testing.assert_allclose(a, b, atol=1e-5)
        np.testing.assert_array_equal(before.geometry.uvs, after.geometry.uvs)
        p, n = placed(after)
        corners = p[after.geometry.indices].astype(np.float64)
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        means = n[after.geometry.indices].mean(axis=1)
        assert (np.einsum("ij,ij->i", face, means) > 0).all()  # the front is still the front
    assert read.camera.position == camera.position
    assert read.camera.fov_y_deg == pytest.approx(camera.fov_y_deg, rel=1e-6)
    look = np.subtract(camera.target, camera.position)
    again = np.subtract(read.camera.target, read.camera.position)
    np.testing.assert_allclose(again, look / np.linalg.norm(look), atol=1e-7)
    right = [np.cross(v, c.up) for v, c in ((look, camera), (again, read.camera))]
    np.testing.assert_allclose(*(r / np.linalg.norm(r) for r in right), atol=1e-7)


MATERIALS = {
    "lambert": Material(base_color=(0.1, 0.2, 0.3), specular=0.0),
    "one-sided": Material(base_color=(0.1, 0.2, 0.3), specular=0.0, **SIDES["front"]),
    "metal's front": Material(base_color=(0.9, 0.7, 0.3), metallic=1.0, **SIDES["front"]),
    "plastic": Material(base_color=(0.6, 0.5, 0.4), roughness=0.3, specular=0.7),
    "metal": Material(base_color=(0.9, 0.7, 0.3), roughness=0.2, metallic=1.0),
    "dull metal": Material(roughness=0.2, metallic=0.5, specular=0.0),
    "lamp": Material(base_color=(0, 0, 0), specular=0.0, emission=(3, 2, 1)),
    "lamp one-sided": Material(specular=0.0, emission=(3, 2, 1), two_sided=False),
}


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_come_back(tmp_path: Path, name: str) -> None:
    before = MATERIALS[name]
    read, _ = there_and_back(Scene(meshes=(quad(before),)), tmp_path)
    (mesh,) = read.meshes
    after = mesh.material
    assert after.two_sided == before.two_sided
    assert after.is_culled is False
    np.testing.assert_allclose(after.base_color, before.base_color, rtol=1e-6)
    np.testing.assert_allclose(after.emission, before.emission, rtol=1e-6)
    for value in ("metallic", "specular"):
        assert getattr(after, value) == pytest.approx(getattr(before, value), rel=1e-6), value
    if before.specular or before.metallic:
        assert after.roughness == pytest.approx(before.roughness)


def test_textures_come_back(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 255, (8, 4, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    color = Texture(pixels, wrap=("mirror", "mirror"), scale=(2, 3), offset=(0.25, 0.5))
    data = replace(color, is_srgb=False)
    tilted = np.full((2, 2, 4), 255, np.uint8)
    tilted[..., :3] = (200, 128, 233)
    before = Material(
        base_color=(1, 1, 1),
        base_color_texture=color,
        metallic=1.0,
        metallic_roughness_texture=data,
        normal_texture=Texture(tilted, is_srgb=False),
    )
    glowing = Material(
        base_color=(0.5, 1, 0.25),
        base_color_texture=replace(color, scale=(1, 1), offset=(0, 0)),
        specular=0.0,
        emission=(4, 4, 4),
        emission_texture=replace(color, scale=(1, 1), offset=(0, 0), wrap=("repeat", "repeat")),
    )
    read, notes = there_and_back(Scene(meshes=(quad(before), quad(glowing))), tmp_path)
    after = read.meshes[0].material
    np.testing.assert_array_equal(after.base_color_texture.pixels, pixels)
    assert after.base_color_texture.scale == (2, 3)
    assert after.base_color_texture.offset == (0.25, 0.5)
    assert after.base_color_texture.wrap == ("mirror", "mirror")
    packed = after.metallic_roughness_texture.pixels.astype(int)
    np.testing.assert_allclose(packed[..., 1:3], pixels[..., 1:3], atol=1)
    normal = after.normal_texture.pixels[0, 0, :3].astype(float) / 127.5 - 1
    expected = np.array([200, 128, 233]) / 127.5 - 1
    np.testing.assert_allclose(normal, expected / np.linalg.norm(expected), atol=0.01)
    light = read.meshes[1].material
    assert light.two_sided
    decoded = (pixels[..., :3] / 255.0 + 0.055) / 1.055
    shown = light.emission_texture.pixels[..., :3] / 255.0
    back = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    linear = np.where(
        pixels[..., :3] / 255.0 <= 0.04045, pixels[..., :3] / 255 / 12.92, decoded**2.4
    )
    np.testing.assert_allclose(back * light.emission[0], 4 * linear, atol=0.02)
    tinted = light.base_color_texture.pixels[..., :3] / 255.0
    tinted = np.where(tinted <= 0.04045, tinted / 12.92, ((tinted + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(tinted, linear * (0.5, 1, 0.25), atol=0.005)
    assert notes == [PRINCIPLED]


def test_alpha_masks_and_vertex_colours_come_back(tmp_path: Path) -> None:
    pixels = np.full((8, 8, 4), 255, np.uint8)
    pixels[:, :4, 3] = 0
    leaf = Material(
        base_color=(1, 1, 1),
        base_color_texture=Texture(pixels, wrap=("clamp", "clamp")),
        alpha_cutoff=0.5,
        specular=0.0,
    )
    absent = Material(alpha=0.2, alpha_cutoff=0.5)
    colors = np.ones((4, 4), np.float32)
    colors[:, :3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]]
    painted = Material(base_color=(0.5, 1, 1), specular=0.0)
    meshes = (quad(leaf), quad(absent), quad(painted, colors))
    read, notes = there_and_back(Scene(meshes=meshes), tmp_path)
    cut, shown = read.meshes
    alpha = cut.material.base_color_texture.pixels[..., 3]
    assert cut.material.alpha_cutoff == 0.5
    assert (alpha[:, : alpha.shape[1] // 2 - 2] == 0).all()
    assert (alpha[:, alpha.shape[1] // 2 + 2 :] == 255).all()
    product = shown.geometry.colors[:, :3] * shown.material.base_color
    np.testing.assert_allclose(product, colors[:, :3] * (0.5, 1, 1), atol=1e-6)
    assert notes == []


def test_lights_and_environment_come_back(tmp_path: Path) -> None:
    lights = (
        DirectionalLight((0.3, -0.9, 0.1), (3, 2, 1)),
        PointLight((1, 2, 3), (4, 5, 6)),
        SpotLight((0, 3, 0), (0.1, -1, 0.3), (7, 8, 9), inner_deg=11, outer_deg=33),
        SpotLight((0, 3, 0), (0.0, -1, 0.0), (7, 8, 9), inner_deg=33, outer_deg=33),
    )
    pixels = np.random.default_rng(0).random((4, 8, 3), np.float32)
    sky = Environment(map=pixels, scale=2.5, rotation_deg=-70, visible=False)
    read, notes = there_and_back(Scene(lights=lights, environment=sky), tmp_path)
    assert notes == [] and read.warnings == ()
    for before, after in zip(lights, read.lights, strict=True):
        for name in vars(before):
            np.testing.assert_allclose(getattr(after, name), getattr(before, name), atol=1e-6)
    np.testing.assert_array_equal(read.environment.map, pixels)
    assert read.environment.scale == 2.5 and not read.environment.visible
    assert read.environment.rotation_deg == pytest.approx(-70)


def test_media_come_back(tmp_path: Path) -> None:
    """Air, a grid and a ball inside it, and a box outside: written as sums, read as parts."""
    density = np.random.default_rng(2).random((3, 4, 5)).astype(np.float32)
    angle = math.radians(30)
    turn = np.eye(4)
    turn[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    air = Medium((0.1, 0.2, 0.3), (0.9, 0.9, 0.9), (0.2,) * 3, ((-3, -3, -3), (3, 3, 3)))
    grid = Volume(
        (1, 2, 3),
        density,
        bounds=((-1, 0, -1), (1, 1, 1)),
        albedo=(0.9,) * 3,
        g=(0.2,) * 3,
        world_from_volume=turn,
    )
    ball = Volume(
        (2, 2, 2),
        shape="sphere",
        bounds=((-1, -2.5, -1), (1, -0.5, 1)),
        albedo=(0.5, 0.6, 0.7),
        g=(0.2,) * 3,
    )
    far = Volume((1, 1, 1), shape="box", bounds=((10, 0, 0), (11, 1, 1)), g=(-0.3,) * 3)
    scene = Scene(medium=air, volumes=(grid, ball, far))
    read, notes = there_and_back(scene, tmp_path)
    assert notes == []
    np.testing.assert_allclose(read.medium.sigma_t, air.sigma_t, rtol=1e-6)
    np.testing.assert_allclose(read.medium.bounds, air.bounds, atol=2e-3)
    assert (read.medium.albedo, read.medium.g) == (air.albedo, air.g)
    for before, after in zip(scene.volumes, read.volumes, strict=True):
        np.testing.assert_allclose(after.albedo, before.albedo, rtol=2e-5)
        assert after.g == before.g and after.shape == before.shape
        if before.density is None:
            np.testing.assert_allclose(after.sigma_t, before.sigma_t, rtol=1e-6)
        else:
            for c in range(3):
                a, b = (v.density * v.sigma_t[c] for v in (after, before))
                np.testing.assert_allclose(a, b, atol=1e-5)
        ends = [
            [v.world_from_volume @ [*corner, 1.0] for corner in v.bounds] for v in (after, before)
        ]
        np.testing.assert_allclose(*ends, atol=3e-4)


def test_approximations_are_told(tmp_path: Path) -> None:
    colors = np.ones((4, 4), np.float32)
    colors[0, :3] = 0
    texture = Texture(
        np.full((2, 2, 4), 200, np.uint8), wrap=("clamp", "repeat"), source="wall.png"
    )
    both = Material(name="wall", base_color_texture=texture, specular=0.0, two_sided=False)
    repeated = Material(
        name="sign",
        specular=0.0,
        emission=(1, 1, 1),
        base_color=(0, 0, 0),
        emission_texture=Texture(np.full((2, 2, 4), 200, np.uint8), scale=(3, 3)),
    )
    smoke = Volume(
        (1, 1, 1), density=np.ones((2, 2, 2)), g=(0, 0, 0.5), detail=0.5, source="smoke.vol"
    )
    scene = Scene(
        meshes=(quad(both, colors), quad(repeated)),
        volumes=(smoke,),
        environment=Environment(visible=False),
    )
    notes = write_mitsuba(scene, tmp_path / "a.xml")
    assert notes == [
        "g differs between the channels, written as its mean",
        "material 'wall': vertex colours beside a base-colour texture are replaced by their mean",
        "texture wall.png: clamped along one axis only, written as clamped along both",
        "one-sided surfaces are black from behind in Mitsuba, where airlight's cameras look "
        "through them",
        "material 'sign': its emission texture repeats or overlaps, each triangle glows in its "
        "mean colour",
        "volume smoke.vol: its procedural detail is left out",
        "the environment is visible: Mitsuba hides all emitters or none",
    ]


def test_files_appear_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(meshes=(Mesh(box()),))
    target = tmp_path / "out.xml"
    write_mitsuba(scene, target)
    write_mitsuba(replace(scene, meshes=scene.meshes * 2), target)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.xml", "out_files"]
    assert len(load_mitsuba(target).meshes) == 2
    before = target.read_bytes()

    def fail(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(mitsuba_scene, "_write_xml", fail)
    with pytest.raises(OutputError) as caught:
        write_mitsuba(scene, target)
    assert str(caught.value).startswith(f"{target}: cannot be written (No space left on device)")
    assert target.read_bytes() == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.xml", "out_files"]
    with pytest.raises(OutputError, match="does not exist"):
        write_mitsuba(scene, tmp_path / "nowhere" / "out.xml")
