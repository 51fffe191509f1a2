"""Scenes moved to an origin near their camera."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.scene import (
    AreaLight,
    Camera,
    DirectionalLight,
    Medium,
    Mesh,
    PointLight,
    PointLights,
    Scene,
    Volume,
)
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.tracks import CameraTrack, MeshTrack, Placing
from airlight.scene.builtin import BUILTIN, builtin_scene
from airlight.scene.nearby import Nearby, origin_near
from airlight.scene.shapes import box

FAR = np.array((9000.5, -20.25, 512.0))


def at(*p: float) -> tuple[float, float, float]:
    x, y, z = (FAR + p).tolist()
    return (x, y, z)


def placed(*p: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = at(*p)
    return matrix


def far_scene() -> Scene:
    """Something of each kind that has a place, around FAR."""
    return Scene(
        meshes=(Mesh(box(), world_from_object=placed(0, 0, 0)),),
        lights=(
            DirectionalLight((0, -1, 0), 1.0),
            PointLight(at(0, 2, 0), 1.0),
            AreaLight(at(1, 2, 0), 1.0, size=(0.3, 0.2)),
        ),
        camera=Camera(at(0, 1, 4), at(0, 1, 0)),
        medium=Medium(0.1, bounds=(at(-2, 0, -2), at(2, 3, 2))),
        volumes=(Volume(0.5, shape="box", world_from_volume=placed(0, 1, 0)),),
        light_groups=(PointLights(np.array([at(0.5, 1, 0)]), np.ones((1, 3))),),
    )


@pytest.mark.parametrize("name", BUILTIN)
def test_scenes_around_the_worlds_origin_keep_it(name):
    scene = builtin_scene(name)
    assert origin_near(scene) == (0.0, 0.0, 0.0)
    assert Nearby((0.0, 0.0, 0.0)).of(scene) is scene


def test_an_origin_is_near_and_exact_in_single_precision():
    scene = far_scene()
    origin = np.array(origin_near(scene))
    assert np.abs(origin - scene.camera.position).max() <= 32.0 * 4.0 / 2.0
    assert (origin.astype(np.float32) == origin).all()


def test_a_camera_that_looks_from_afar_does_not_take_the_origin_with_it():
    """Files say where a camera looks by a point a metre ahead, wherever the scene begins."""
    scene = Scene(meshes=(Mesh(box()),), camera=Camera((0, 0, 900), (0, 0, 899)))
    assert origin_near(scene) == (0.0, 0.0, 0.0)


def test_a_house_in_a_wide_plain_has_its_own_origin():
    plain = Mesh(box(), world_from_object=np.diag([4000.0, 0.1, 4000.0, 1.0]))
    scene = Scene(meshes=(plain,), camera=Camera((700, 2, 5), (700, 2, 0)))
    assert origin_near(scene) == (640.0, 0.0, 0.0)  # in steps of 128 m: 5 m are looked at


def test_all_that_has_a_place_moves():
    assert {f.name for f in dataclasses.fields(Scene)} == {
        *("meshes", "lights", "camera", "medium", "volumes", "light_groups", "animation"),
        *("environment", "settings", "name", "warnings"),  # these have none
    }
    scene = far_scene()
    near = Nearby(tuple(FAR)).of(scene)
    assert near.camera == Camera((0, 1, 4), (0, 1, 0))
    assert near.lights[0] == scene.lights[0]
    assert [light.position for light in near.lights[1:]] == [(0, 2, 0), (1, 2, 0)]
    assert near.lights[2].size == (0.3, 0.2)
    assert near.medium.bounds == ((-2, 0, -2), (2, 3, 2))
    np.testing.assert_array_equal(near.meshes[0].world_from_object, np.eye(4))
    np.testing.assert_array_equal(near.volumes[0].world_from_volume[:3, 3], (0, 1, 0))
    np.testing.assert_allclose(near.light_groups[0].positions, [(0.5, 1, 0)], atol=1e-3)
    assert Nearby(tuple(FAR)).box((9000.5, -20.25, 512, 9001.5, 0, 513)) == (0, 0, 0, 1, 20.25, 1)
    fog = dataclasses.replace(scene, medium=Medium(0.1, endless=True, top=5.0))
    assert Nearby(tuple(FAR)).of(fog).medium.top == 25.25


def test_what_has_not_changed_stays_the_same_object():
    nearby, scene = Nearby(tuple(FAR)), far_scene()
    first = nearby.of(scene)
    assert nearby.of(scene).meshes is first.meshes
    other = Mesh(box(), world_from_object=placed(3, 0, 0))
    second = nearby.of(dataclasses.replace(scene, meshes=(*scene.meshes, other)))
    assert second.meshes[0] is first.meshes[0]
    assert second.volumes is first.volumes and second.lights is first.lights


def test_an_animation_moves_along():
    scene = far_scene()
    there = Curve([0.0, 1.0], [at(0, 1, 4), at(5, 1, 4)])
    moves = Curve([0.0, 1.0], [at(0, 0, 0), at(7, 0, 0)])
    tracks = (
        CameraTrack({"position": there}),
        MeshTrack(0, np.eye(4)[None], Placing({"translate": moves}, {})),
    )
    scene = dataclasses.replace(scene, animation=Animation(tracks))
    near = Nearby(tuple(FAR)).of(scene)
    for got, wanted in zip(near.whole_bounds, scene.whole_bounds, strict=True):
        np.testing.assert_allclose(got, wanted - FAR, atol=1e-9)
    np.testing.assert_allclose(near.animation.eyes(near)[-1], (5, 1, 4), atol=1e-9)
    later = near.at(1.0)
    np.testing.assert_allclose(later.camera.position, (5, 1, 4), atol=1e-9)
    np.testing.assert_allclose(later.meshes[0].world_from_object[:3, 3], (7, 0, 0), atol=1e-9)
    assert later.animation is near.animation
