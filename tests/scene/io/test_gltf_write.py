"""Scenes written as GLB, read again, and held to what was written."""

from __future__ import annotations

import json
import struct
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from airlight.area.emitters import Emitters
from airlight.errors import OutputError
from airlight.scene import (
    AreaLight,
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Medium,
    Mesh,
    PointLight,
    PointLights,
    Scene,
    SpotLight,
    Texture,
)
from airlight.scene.io.gltf import load_gltf
from airlight.scene.io.gltf_write import write_gltf
from airlight.scene.shapes import box, quad, sphere

RNG = np.random.default_rng(5)
PIXELS = RNG.integers(0, 256, (4, 8, 4), dtype=np.uint8)


def back(scene: Scene, folder: Path) -> Scene:
    write_gltf(scene, folder / "scene.glb")
    return load_gltf(folder / "scene.glb")


def document(path: Path) -> dict:
    raw = path.read_bytes()
    magic, version, length, size, kind = struct.unpack_from("<4sIIII", raw)
    assert (magic, version, length, kind) == (b"glTF", 2, len(raw), 0x4E4F534A)
    return json.loads(raw[20 : 20 + size])


def turned() -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = np.linalg.qr(RNG.normal(size=(3, 3)))[0] * (1.0, 2.0, 0.5)
    matrix[:3, 3] = (3, -2, 1)
    return matrix


def corners(mesh: Mesh) -> np.ndarray:
    m = mesh.world_from_object
    world = mesh.geometry.positions[mesh.geometry.indices] @ m[:3, :3].T + m[:3, 3]
    # Fronts: what is mirrored keeps its own.
    return world if np.linalg.det(m[:3, :3]) > 0 else world[:, [0, 2, 1]]


@pytest.mark.parametrize("mirror", [1.0, -1.0])
@pytest.mark.parametrize("shear", [0.0, 0.4])
def test_meshes_come_back_where_they_were(tmp_path: Path, mirror: float, shear: float) -> None:
    matrix = turned()
    matrix[:3, :3] = matrix[:3, :3] @ [[mirror, shear, 0], [0, 1, 0], [0, 0, 1]]
    mesh = Mesh(sphere(), Material(name="m"), matrix, "ball")
    (read,) = back(Scene(meshes=(mesh,)), tmp_path).meshes
    assert read.name == "ball"
    wanted, found = (np.sort(corners(m).reshape(-1, 9), axis=0) for m in (mesh, read))
    np.testing.assert_allclose(found, wanted, atol=2e-6)
    # Normals face as their triangles do.
    for each in (mesh, read):
        triangles = corners(each)
        face = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        inverse = np.linalg.inv(each.world_from_object[:3, :3])
        normals = each.geometry.normals[each.geometry.indices].mean(axis=1) @ inverse
        assert ((face * normals).sum(axis=1) > -1e-9).all()


def test_materials_come_back(tmp_path: Path) -> None:
    colour = Texture(PIXELS, wrap=("mirror", "clamp"), scale=(2.0, 3.0), offset=(0.5, 0.25))
    data = Texture(PIXELS[::-1].copy(), is_srgb=False)
    materials = [
        Material("plain", (0.1, 0.2, 0.3), roughness=0.4, metallic=0.6, specular=0.5),
        Material(
            "images",
            base_color_texture=colour,
            metallic_roughness_texture=data,
            normal_texture=data,
            normal_scale=0.7,
            alpha=0.9,
            alpha_cutoff=0.3,
            two_sided=False,
        ),
        Material("glow", emission=(7.0, 5.0, 0.5), emission_texture=colour),
        Material("front", two_sided=False, has_black_back=True),
        Material("dim", emission=(0.5, 0.25, 0.0)),
    ]
    meshes = tuple(Mesh(quad(), m, name=m.name) for m in materials)
    read = back(Scene(meshes=meshes), tmp_path)
    assert read.warnings == ()
    for wanted, mesh in zip(materials, read.meshes, strict=True):
        for field in fields(Material):
            value, found = getattr(wanted, field.name), getattr(mesh.material, field.name)
            if isinstance(value, Texture):
                np.testing.assert_array_equal(found.pixels, value.pixels)
                for name in ("is_srgb", "wrap", "scale", "offset"):
                    assert getattr(found, name) == getattr(value, name)
            elif isinstance(value, float | tuple):
                np.testing.assert_allclose(found, value, rtol=1e-6)
            else:
                assert found == value, field.name


def test_images_of_another_coding_are_coded_again(tmp_path: Path) -> None:
    grey = np.full((2, 2, 4), 255, np.uint8)
    grey[..., :3] = 55  # linear; 128 in sRGB
    material = Material("m", base_color_texture=Texture(grey, is_srgb=False))
    notes = write_gltf(Scene(meshes=(Mesh(quad(), material),)), tmp_path / "a.glb")
    assert "coded again" in notes[0]
    found = load_gltf(tmp_path / "a.glb").meshes[0].material.base_color_texture
    assert found.is_srgb
    assert np.abs(found.pixels[..., :3].astype(int) - 128).max() <= 1


def test_punctual_lights_come_back(tmp_path: Path) -> None:
    lights = (
        PointLight((1, 2, 3), (4, 5, 6)),
        SpotLight((1, 2, 3), (1, -2, 3), (40, 5, 0), 12.5, 40),
        SpotLight((0, 2, 0), (0, -1, 0), 0.5, 0, 30),
        DirectionalLight((0, -1, 0), (3, 2, 1)),
    )
    group = PointLights([[1, 2, 3], [4, 5, 6]], [[0.5, 0.25, 0.125]])
    scene = Scene(meshes=(Mesh(quad()),), lights=lights, light_groups=(group,))
    read = back(scene, tmp_path).lights
    wanted = (*lights, *(PointLight(p, (0.5, 0.25, 0.125)) for p in ((1, 2, 3), (4, 5, 6))))
    assert len(read) == len(wanted)
    for found, light in zip(read, wanted, strict=True):
        assert type(found) is type(light)
        for field in fields(light):
            np.testing.assert_allclose(
                getattr(found, field.name), getattr(light, field.name), rtol=1e-6, atol=1e-7
            )


def test_area_lights_are_meshes_that_are_the_same_lights_again(tmp_path: Path) -> None:
    lights = (
        AreaLight((0, 3, 0), (9, 6, 3), size=(2, 1), reflectance=0.5),
        AreaLight((2, 1, 0), 0.5, "disk", direction=(1, 0, 0), two_sided=True),
        AreaLight((-2, 1, 0), 30, "sphere", radius=0.2),
    )
    scene = Scene(meshes=(Mesh(quad()),), lights=lights)
    read = back(scene, tmp_path)
    assert read.lights == ()
    assert [m.material.base_color for m in read.meshes[1:]] == [(0.5,) * 3, (0.0,) * 3, (0.0,) * 3]
    there, here = (Emitters(s, samples=4, most=20) for s in (scene, read))
    for found, state in ((there, scene), (here, read)):
        found.of(state)
    assert len(here.list) == len(there.list) == 4
    for a, b in zip(here.list, there.list, strict=True):
        assert a.shape.kind == b.shape.kind
        np.testing.assert_allclose(a.shape.radiance, b.shape.radiance, rtol=1e-4)
        np.testing.assert_allclose(a.shape.centre, b.shape.centre, atol=1e-5)


def test_the_camera_comes_back(tmp_path: Path) -> None:
    for camera in (
        Camera((1, 2, 3), (0, 1, -2), (0.1, 1, 0), 35),
        Camera((0, 5, 0), (0, 0, 0), fov_y_deg=60),
    ):
        read = back(Scene(meshes=(Mesh(quad()),), camera=camera), tmp_path).camera
        along = np.subtract(camera.target, camera.position)
        along = along / np.linalg.norm(along)
        np.testing.assert_allclose(read.position, camera.position)
        np.testing.assert_allclose(np.subtract(read.target, read.position), along, atol=1e-6)
        assert read.fov_y_deg == pytest.approx(camera.fov_y_deg)
        up = np.array(camera.up) - np.dot(camera.up, along) * along
        np.testing.assert_allclose(read.up, up / np.linalg.norm(up), atol=1e-6)


def test_what_is_shared_is_written_once(tmp_path: Path) -> None:
    shared, material = box(), Material(base_color_texture=Texture(PIXELS))
    meshes = tuple(Mesh(shared, material, turned()) for _ in range(50))
    write_gltf(Scene(meshes=meshes), tmp_path / "a.glb")
    found = document(tmp_path / "a.glb")
    counts = {name: len(found[name]) for name in ("meshes", "materials", "images", "textures")}
    assert counts == {"meshes": 1, "materials": 1, "images": 1, "textures": 1}
    assert len(found["nodes"]) == 51
    for view in found["bufferViews"]:
        assert view["byteOffset"] % 4 == 0


def test_what_gltf_cannot_say_is_told(tmp_path: Path) -> None:
    scene = Scene(
        meshes=(Mesh(quad()),),
        lights=(
            AreaLight((0, 1, 0), 1, visible=False),
            PointLight((0, 1, 0), 1, radius=0.1),
            SpotLight((0, 1, 0), (0, -1, 0), 1, radius=0.1),
        ),
        environment=Environment(radiance=(1, 1, 1)),
        medium=Medium((0.1, 0.1, 0.1)),
    )
    notes = write_gltf(scene, tmp_path / "a.glb")
    assert [" ".join(n.split()[-3:]) for n in notes] == [
        "place in glTF",
        "shadows are hard",
        "for the environment",
        "for the medium",
    ]
    assert len(load_gltf(tmp_path / "a.glb").lights) == 2
    assert (
        write_gltf(replace(scene, lights=(), environment=None, medium=None), tmp_path / "b.glb")
        == []
    )


def test_a_folder_that_is_missing_is_told(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="does not exist"):
        write_gltf(Scene(meshes=(Mesh(quad()),)), tmp_path / "nowhere" / "a.glb")
