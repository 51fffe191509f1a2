"""Fingerprints: equal for equal scenes, another for every change that an image could show."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import Camera, Environment, Material, Mesh, PointLight, Scene, Volume, shapes
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.density import MadeDensity, VolumeTrack
from airlight.scene.animation.file_sequence import FileSequence
from airlight.scene.animation.tracks import CameraTrack
from airlight.scene.builtin.smoke import plume_density
from airlight.scene.fingerprint import array_digest, fingerprint, is_same


def make_scene():
    fov = Curve(np.array([0.0, 1.0]), np.array([[40.0], [50.0]]))
    return Scene(
        meshes=(Mesh(shapes.box(), Material(base_color=(0.5, 0.1, 0.2))),),
        lights=(PointLight((0, 2, 0), (1, 1, 1)),),
        environment=Environment(map=np.ones((4, 8, 3), np.float32)),
        volumes=(Volume((1, 1, 1), density=np.zeros((2, 3, 4), np.float32)),),
        settings={"lpv": {"resolution": 16}},
        animation=Animation(
            (
                CameraTrack({"fov_y_deg": fov}),
                VolumeTrack(0, MadeDensity(partial(plume_density, seed=3))),
            )
        ),
    )


def test_equal_scenes_have_one_fingerprint():
    scene = make_scene()
    assert fingerprint(scene) == fingerprint(make_scene())
    assert fingerprint(scene) == fingerprint(pickle.loads(pickle.dumps(scene)))
    assert fingerprint(replace(scene, warnings=("said",))) == fingerprint(scene)


def test_fields_may_be_left_out():
    """Wherever they stand; those that no image depends on always are."""
    scene = make_scene()
    other = replace(
        scene, settings={}, meshes=(replace(scene.meshes[0], name="another"),), warnings=("said",)
    )
    assert fingerprint(other, without=("settings",)) != fingerprint(scene, without=("settings",))
    left_out = ("settings", "name")
    assert fingerprint(other, without=left_out) == fingerprint(scene, without=left_out)
    assert fingerprint(scene, without=left_out) != fingerprint(scene)


def changed(scene, kind):
    texels = np.ones((4, 8, 3), np.float32)
    texels[2, 5, 1] = 1.0 + 1e-6
    material = replace(scene.meshes[0].material, roughness=0.3)
    track = scene.animation.tracks[0]
    slower = Curve(track.curves["fov_y_deg"].times * 2.0, track.curves["fov_y_deg"].values)
    other_smoke = VolumeTrack(0, MadeDensity(partial(plume_density, seed=4)))
    return {
        "camera": lambda: replace(scene, camera=Camera(fov_y_deg=50.5)),
        "light": lambda: replace(scene, lights=(PointLight((0, 2, 0), (1, 1, 1.5)),)),
        "texel": lambda: replace(scene, environment=Environment(map=texels)),
        "material": lambda: replace(scene, meshes=(replace(scene.meshes[0], material=material),)),
        "settings": lambda: replace(scene, settings={"lpv": {"resolution": 17}}),
        "times": lambda: replace(
            scene,
            animation=Animation((CameraTrack({"fov_y_deg": slower}), scene.animation.tracks[1])),
        ),
        "seed": lambda: replace(scene, animation=Animation((track, other_smoke))),
        "rate": lambda: replace(scene, animation=replace(scene.animation, fps=25.0)),
        "none": lambda: replace(scene, animation=None),
    }[kind]()


KINDS = ["camera", "light", "texel", "material", "settings", "times", "seed", "rate", "none"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_change_shows(kind):
    scene = make_scene()
    assert fingerprint(changed(scene, kind)) != fingerprint(scene)


def test_files_count_by_what_is_in_them(tmp_path):
    files = (tmp_path / "a.npy", tmp_path / "b.npy")
    for file in files:
        np.save(file, np.zeros((2, 2, 2)))
    before = fingerprint(FileSequence(files, (2, 2, 2)))
    np.save(files[1], np.ones((2, 2, 2)))
    assert fingerprint(FileSequence(files, (2, 2, 2))) != before
    files[0].unlink()
    with pytest.raises(SceneError, match=r"a\.npy: file not found"):
        fingerprint(FileSequence(files, (2, 2, 2)))


def test_what_has_no_fixed_content_is_refused():
    with pytest.raises(TypeError, match="object has no fixed content"):
        fingerprint(object())


def test_a_digest_tells_types_shapes_and_values_apart():
    a = np.arange(6, dtype=np.float32)
    assert array_digest(a) == array_digest(a.copy()) == array_digest(np.repeat(a, 2)[::2])
    others = [a.reshape(2, 3), a.view(np.uint32), a + 1, a.astype(np.float16), a[:0]]
    digests = {array_digest(x) for x in (a, None, *others)}
    assert len(digests | {array_digest(a, None), array_digest(a, a)}) == 9


def test_scenes_are_compared_by_identity_and_plain_values_by_value():
    parts = object()
    assert is_same((parts, 1.0, "a"), (parts, 1.0, "a"))
    assert not is_same((parts, 1.0), (object(), 1.0))
    assert not is_same((parts,), (parts, 1.0))
