"""Every builtin scene: it builds, twice the same, with a camera, light and sound surfaces."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Scene
from airlight.scene.builtin import BUILTIN, builtin_scene

from .conftest import built

DEAR = ("atrium-fog", "foggy-room")
"""The same surfaces as another, in air."""


def digest(scene: Scene) -> str:
    """A hash of all that is to be rendered."""
    total = hashlib.sha256(repr((scene.lights, scene.camera, scene.medium)).encode())
    parts: dict[int, np.ndarray] = {}
    for mesh in scene.meshes:
        geometry, material = mesh.geometry, mesh.material
        total.update(mesh.world_from_object)
        total.update(repr((material.name, material.base_color, material.roughness)).encode())
        textures = (material.base_color_texture, material.normal_texture)
        shared = (geometry.positions, geometry.indices, geometry.normals, geometry.uvs)
        for part in (*shared, *(texture.pixels for texture in textures if texture is not None)):
            if id(part) not in parts:
                parts[id(part)] = part
                total.update(np.ascontiguousarray(part))
    for volume in scene.volumes:
        total.update(volume.density)
    if scene.environment is not None and scene.environment.map is not None:
        total.update(scene.environment.map)
    return total.hexdigest()


@pytest.mark.parametrize("name", [name for name in BUILTIN if name not in DEAR])
def test_is_the_same_every_time_and_sound(name: str) -> None:
    scene = built(name)
    assert scene.name == name
    assert digest(scene) == digest(builtin_scene(name))
    glows = any(mesh.material.is_emissive for mesh in scene.meshes)
    assert scene.lights or scene.environment or glows
    low, high = scene.bounds
    assert np.all(high > low) and np.linalg.norm(high - low) < 200.0
    distance = np.linalg.norm(np.subtract(scene.camera.position, (low + high) / 2))
    assert distance < 2.0 * np.linalg.norm(high - low)


@pytest.mark.parametrize("name", ["atrium", "cornell", "room", "smoke", "wall-floor"])
def test_surfaces_face_along_unit_normals(name: str) -> None:
    for geometry in {id(m.geometry): m.geometry for m in built(name).meshes}.values():
        assert geometry.normals is not None and geometry.uvs is not None
        assert np.allclose(np.linalg.norm(geometry.normals, axis=1), 1.0, atol=1e-5)
        corners = geometry.positions[geometry.indices].astype(np.float64)
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(face, axis=1)
        assert area.min() > 0.0
        shading = geometry.normals[geometry.indices].mean(axis=1)
        assert np.all(np.einsum("ij,ij->i", face, shading) >= 0.0)


def test_fog_fills_the_scenes_of_that_name() -> None:
    for name, sigma in (("foggy-room", 0.12), ("haze-box", 0.12), ("atrium-fog", 0.03)):
        medium = built(name).medium
        assert medium is not None
        assert np.allclose(medium.sigma_s, sigma) and np.allclose(medium.sigma_a, 0.0)
    assert builtin_scene("haze-box", sigma_s=0.5).medium.sigma_t == (0.5, 0.5, 0.5)


def test_unknown_names_are_told_the_nearest() -> None:
    with pytest.raises(SceneError) as told:
        builtin_scene("attrium")
    assert str(told.value) == "there is no builtin scene 'attrium'. Did you mean 'atrium'?"
    with pytest.raises(SceneError) as told:
        builtin_scene("smoke", times=1.0)
    assert str(told.value) == "builtin scene 'smoke' has no option 'times'. Did you mean 'time'?"


def test_every_scene_says_in_one_line_what_it_shows() -> None:
    for make in BUILTIN.values():
        first = (make.__doc__ or "").splitlines()[0]
        assert 20 < len(first) < 100 and first.endswith(".")
