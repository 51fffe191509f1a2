"""Which part of a grid a camera is to show: where nearly all of it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene import Emission, Mesh, Scene, Volume
from airlight.scene.animation import Animation
from airlight.scene.animation.density import MadeDensity, VolumeTrack
from airlight.scene.io import load
from airlight.scene.io.defaults import with_default_camera
from airlight.scene.io.dense_part import dense_box
from airlight.scene.shapes import box

BOX = ((-10.0, 0.0, 0.0), (10.0, 20.0, 40.0))


def grid(*parts, shape=(40, 20, 20)):
    values = np.zeros(shape, np.float32)
    for z, y, x in parts:
        values[z, y, x] = 1.0
    return values


def of(density, **values):
    return Volume(sigma_t=1.0, density=density, bounds=BOX, **values)


def test_a_full_grid_is_its_box():
    low, high = dense_box(Scene(volumes=(of(np.ones((4, 5, 6), np.float32)),)))
    np.testing.assert_array_equal((low, high), BOX)


def test_empty_space_and_faint_dust_are_left_out():
    density = grid((slice(10, 20), slice(4, 8), slice(0, 5)))
    dusty = density + np.float32(1e-6)
    for values in (density, dusty):
        low, high = dense_box(Scene(volumes=(of(values),)))
        # Of 10, 4 and 5 voxels of 1 m no half is lost, and none of the emptiness is kept.
        np.testing.assert_allclose(low, (-10, 4, 10), atol=0.4)
        np.testing.assert_allclose(high, (-5, 8, 20), atol=0.4)


def test_it_turns_with_its_volume_and_holds_all_volumes_and_fires():
    turned = np.array([[0, 0, 1.0, 5], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])
    density = grid((slice(10, 20), slice(4, 8), slice(0, 5)))
    placed = of(density, world_from_volume=turned)
    low, high = dense_box(Scene(volumes=(placed,)))
    np.testing.assert_allclose((low, high), ((15, 4, 5), (25, 8, 10)), atol=0.4)
    ball = Volume(sigma_t=1.0, shape="sphere", bounds=((50, 0, 0), (51, 1, 1)))
    glow = grid((slice(30, 31), slice(19, 20), slice(0, 1)))
    fire = of(density, emission=Emission((1, 1, 1), glow))
    assert dense_box(Scene(volumes=(placed, ball)))[1][0] == 51
    np.testing.assert_allclose(dense_box(Scene(volumes=(fire,)))[1], (-5, 20, 31), atol=0.4)


def test_what_grows_is_framed_whole():
    def grown(time_s):
        return grid((slice(0, 1 + int(39 * time_s)), slice(0, 20), slice(0, 20)))

    moving = Animation((VolumeTrack(0, MadeDensity(grown, 1.0)),))
    low, high = dense_box(Scene(volumes=(of(grown(0.0)),), animation=moving))
    np.testing.assert_allclose((low, high), BOX, atol=0.4)


def test_each_of_the_files_of_a_sequence_is_framed(tmp_path):
    """A puff that is elsewhere in one of many files."""
    count, odd = 30, 11
    for k in range(count):
        where = slice(18, 20) if k == odd else slice(0, 2)
        np.save(tmp_path / f"a{k:02d}.npy", grid((where, where, where), shape=(20, 20, 20)))
    low, high = dense_box(load(tmp_path))
    np.testing.assert_allclose((low, high), ((-1, -1, -1), (1, 1, 1)), atol=0.02)


def test_of_large_grids_a_few_files_are_framed(tmp_path, monkeypatch):
    seen = []
    for k in range(30):
        np.save(tmp_path / f"a{k:02d}.npy", np.ones((4, 4, 4), np.float32))
    scene, at = load(tmp_path), Scene.at
    monkeypatch.setattr(Scene, "at", lambda self, time: (seen.append(time), at(self, time))[1])
    monkeypatch.setattr("airlight.scene.io.dense_part._VOXELS", 500)
    dense_box(scene)
    # Evenly through them, at the very times of files, and the last one.
    np.testing.assert_allclose(np.array(seen) * 24, np.linspace(0, 29, 7).round())


def test_a_small_cloud_in_a_large_domain_fills_the_view():
    whole = with_default_camera(Scene(volumes=(of(np.ones((40, 20, 20), np.float32)),)))
    small = with_default_camera(
        Scene(volumes=(of(grid((slice(18, 22), slice(8, 12), slice(8, 12)))),))
    )
    away = [np.linalg.norm(np.subtract(s.camera.position, s.camera.target)) for s in (whole, small)]
    assert away[1] < 0.3 * away[0]
    assert small.camera.target == pytest.approx((0, 10, 20), abs=1.0)


def test_fog_around_a_model_and_shapes_leave_its_view_as_it_is():
    model = Scene(meshes=(Mesh(box()),))
    usual = with_default_camera(model).camera
    fog = Volume(1.0, np.ones((4, 4, 4), np.float32), bounds=((-50, -50, -50), (50, 50, 50)))
    haze = Volume(1.0, shape="box", bounds=((40, 0, 0), (50, 10, 10)))
    empty = Volume(1.0, np.zeros((4, 4, 4), np.float32), bounds=((40, 0, 0), (50, 10, 10)))
    for volume in (fog, haze, empty):
        assert with_default_camera(replace(model, volumes=(volume,))).camera == usual
