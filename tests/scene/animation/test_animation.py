"""A scene at a time: what moves is there, whatever was asked before; mistakes are named."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Mesh,
    PointLight,
    Scene,
    Volume,
    shapes,
)
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.density import MadeDensity, VolumeTrack
from airlight.scene.animation.file_sequence import FileSequence
from airlight.scene.animation.tracks import (
    CameraTrack,
    EnvironmentTrack,
    LightTrack,
    MeshTrack,
    Placing,
)


def line(*values, times=(0.0, 2.0)):
    return Curve(np.array(times), np.array(values, float).reshape(len(times), -1), "linear")


def growing(time_s):
    return np.full((2, 3, 4), 0.25 * time_s, np.float32)


def moving_scene():
    shift = np.eye(4)
    shift[:3, 3] = (0, 5, 0)
    return Scene(
        meshes=(Mesh(shapes.quad()), Mesh(shapes.box(), world_from_object=shift)),
        lights=(DirectionalLight((0, -1, 0), (1, 1, 1)), PointLight((0, 0, 0), (1, 1, 1))),
        environment=Environment(),
        volumes=(Volume((1, 1, 1), density=growing(0.0)),),
        camera=Camera(exposure_stops=-1.0),
        animation=Animation(
            (
                CameraTrack({"position": line((0, 1, 5), (4, 1, 5)), "fov_y_deg": line(40, 60)}),
                LightTrack(
                    1,
                    {
                        "position": line((0, 0, 0), (0, 2, 0)),
                        "intensity": line((1, 1, 1), (-1, 3, 1)),
                    },
                ),
                MeshTrack(
                    1,
                    shift[None],
                    Placing(
                        {"rotate_deg": line((0, 0, 0), (0, 0, 90))}, {"translate": (1.0, 0.0, 0.0)}
                    ),
                ),
                EnvironmentTrack({"rotation_deg": line(0, 90)}),
                VolumeTrack(0, MadeDensity(growing)),
            )
        ),
    )


def summary(scene):
    return (
        scene.camera,
        scene.lights,
        scene.environment.rotation_deg,
        [m.world_from_object.tobytes() for m in scene.meshes],
        scene.volumes[0].density.tobytes(),
    )


def test_everything_is_where_its_keyframes_say():
    half = moving_scene().at(1.0)
    assert half.camera == Camera((2, 1, 5), fov_y_deg=50.0, exposure_stops=-1.0)
    assert half.lights[1] == PointLight((0, 1, 0), (0, 2, 1))
    assert half.environment.rotation_deg == 45.0
    assert float(half.volumes[0].density.max()) == 0.25
    # 5 up, turned by 45 degrees about Z, and 1 to the right.
    s = 5.0 * np.sqrt(0.5)
    np.testing.assert_allclose(half.meshes[1].world_from_object[:3, 3], [1 - s, s, 0], atol=1e-12)
    np.testing.assert_array_equal(half.meshes[0].world_from_object, np.eye(4))


def test_light_never_goes_below_zero():
    assert moving_scene().at(2.0).lights[1].intensity == (0, 3, 1)


def test_a_time_does_not_remember_other_times():
    scene = moving_scene()
    wandered = scene.at(1.7).at(0.2).at(5.0).at(0.6)
    assert (
        summary(wandered)
        == summary(scene.at(0.6))
        == summary(pickle.loads(pickle.dumps(scene)).at(0.6))
    )


def test_many_moving_meshes_make_one_new_scene_together(monkeypatch):
    """A scene for each track would take the square of their number."""
    made = []
    monkeypatch.setattr(Scene, "_check_types", lambda scene: made.append(scene))
    meshes = tuple(Mesh(shapes.quad(), name=str(k)) for k in range(50))
    rise = Placing({"translate": line((0, 0, 0), (0, 2, 0))}, {})
    tracks = tuple(MeshTrack(k, np.eye(4)[None], rise) for k in range(50))
    scene = Scene(meshes=meshes, animation=Animation(tracks))
    made.clear()
    moved = scene.at(1.0)
    assert len(made) == 1
    assert {mesh.world_from_object[1, 3] for mesh in moved.meshes} == {1.0}
    assert [mesh.name for mesh in moved.meshes] == [mesh.name for mesh in meshes]


def test_a_scene_that_does_not_move_is_itself():
    scene = Scene()
    assert scene.at(3.0) is scene


def test_time_goes_round_in_a_loop():
    scene = moving_scene()
    animation = replace(scene.animation, is_loop=True, end_s=2.0)
    looped = replace(scene, animation=animation)
    assert summary(looped.at(2.5)) == summary(looped.at(0.5)) == summary(scene.at(0.5))
    assert summary(looped.at(-0.5)) == summary(scene.at(1.5))


def test_it_ends_with_the_last_keyframe_or_after_a_while():
    assert moving_scene().animation.last_s == 2.0
    assert Animation((VolumeTrack(0, MadeDensity(growing)),), start_s=1.0).last_s == 11.0
    assert Animation((), end_s=3.0).last_s == 3.0


def test_bounds_hold_all_that_the_meshes_reach():
    scene = moving_scene()
    low, high = scene.animation.bounds(scene)
    for time in np.linspace(0.0, 2.0, 17):
        inner_low, inner_high = scene.at(time).bounds
        assert (low <= inner_low + 1e-3).all() and (high >= inner_high - 1e-3).all()


def test_what_cannot_be_names_the_time():
    still = Scene(animation=Animation((CameraTrack({"position": line((0, 1, 5), (0, 1, -5))}),)))
    with pytest.raises(SceneError) as caught:
        still.at(1.0)
    assert str(caught.value) == "at 1 s: camera position and target are the same point"
    for value, message in [
        ("now", "time_s must be a number, not 'now'"),
        (np.nan, "time_s is nan, it must be finite"),
    ]:
        with pytest.raises(SceneError, match=message):
            still.at(value)


@pytest.mark.parametrize(
    ("track", "message"),
    [
        (LightTrack(2, {"intensity": line(1, 2)}), "at 0 s: the animation moves light 3, but"),
        (MeshTrack(1, np.eye(4)[None], Placing({}, {})), "moves mesh 2, but the scene has 1"),
        (EnvironmentTrack({"scale": line(1, 2)}), "the scene has no environment to move"),
        (VolumeTrack(0, MadeDensity(growing)), "changes volume 1, but the scene has 0"),
    ],
)
def test_tracks_of_what_is_not_there_are_refused(track, message):
    scene = Scene(meshes=(Mesh(shapes.quad()),), animation=Animation((track,)))
    with pytest.raises(SceneError, match=message):
        scene.at(0.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: line(1, 2, times=(1.0, 1.0)), "keyframe times must rise, but 1 s comes after 1 s"),
        (lambda: line(1, np.inf), "a keyframe is NaN or infinite"),
        (lambda: Curve(np.zeros(2), np.zeros((3, 1))), "3 keyframes have 2 times"),
        (lambda: Animation(start_s=2.0, end_s=2.0), "end_s = 2 is not after start_s = 2"),
        (lambda: Animation(fps=0.0), "animation fps = 0 is outside"),
    ],
)
def test_impossible_animations_are_refused(make, message):
    with pytest.raises(SceneError, match=message):
        make()


@pytest.fixture
def sequence(tmp_path):
    """Four files of 2 x 3 x 4, of density 0, 1, 2 and 3."""
    files = tuple(tmp_path / f"smoke.{k}.npy" for k in range(4))
    for k, file in enumerate(files):
        np.save(file, np.full((2, 3, 4), k, np.float32))
    return FileSequence(files, (2, 3, 4), fps=2.0, start_s=1.0)


def density_at(sequence, time_s):
    volume = Volume((1, 1, 1), density=growing(1.0))
    return sequence.of(volume, time_s).density


def test_files_are_mixed_in_between(sequence):
    times = (0.0, 1.0, 1.25, 1.5, 2.375, 9.0)
    found = [float(density_at(sequence, t).max()) for t in times]
    assert found == [0.0, 0.0, 0.5, 1.0, 2.75, 3.0]
    assert sequence.end_s == 3.0
    stepped = replace(sequence, between="step")
    assert density_at(stepped, 1.49).max() == 0.0 and density_at(stepped, 1.5).max() == 1.0
    looped = replace(sequence, is_loop=True)
    assert density_at(looped, 2.75).max() == 1.5 and density_at(looped, 3.0).max() == 0.0


def test_an_unchanged_file_is_an_unchanged_volume(sequence):
    track = VolumeTrack(0, replace(sequence, between="step"))
    scene = track.apply(Scene(volumes=(Volume((1, 1, 1), density=growing(1.0)),)), 1.0)
    assert track.apply(scene, 1.2).volumes[0] is scene.volumes[0]
    assert track.apply(scene, 1.6).volumes[0] is not scene.volumes[0]


def test_files_that_do_not_fit_are_named(sequence):
    np.save(sequence.files[2], np.ones((2, 3, 5), np.float32))
    with pytest.raises(SceneError) as caught:
        density_at(sequence, 2.0)
    assert str(caught.value) == (
        f"{sequence.files[2]}: its grid has 2 x 3 x 5 cells, the sequence's first has 2 x 3 x 4. "
        "Resample the sequence to one size."
    )
    sequence.files[3].unlink()
    with pytest.raises(SceneError, match=r"cannot be read \(No such file or directory\)"):
        density_at(sequence, 9.0)
