"""Ordinates drawn to what the camera sees: nearer to many, steady, without memory."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths.latlong import latlong_texel_directions
from airlight.maths.transforms import F64
from airlight.pop.light.illumination import Illumination
from airlight.pop.light.importance import Look, ViewImportance, coarse_medium
from airlight.pop.medium.placement import placed
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.scene import Camera, Environment, Volume

BALL = Volume((4.0,) * 3, shape="sphere", g=(0.9,) * 3)
CAMERA = Camera((0.0, 0.4, 5.0), (0.0, 0.0, 0.0), fov_y_deg=40.0)
TOWARDS = latlong_texel_directions(48, 96)
WINDOW = TOWARDS @ np.array([0.28, 0.0, -0.96]) > 0.985
MAP = (0.2 + 25.0 * WINDOW[..., None] * np.ones(3)).astype(np.float32)
SKY = Environment(map=MAP)


def emission(gpu: Gpu, count: int, **s: str) -> F64:
    settings = PopSettings(ordinates=count, grid=8, solver_steps=16, furnace_correction=0.0, **s)
    solver = PopSolver(gpu, BALL, settings)
    return look_at(solver, CAMERA)


def look_at(solver: PopSolver, camera: Camera) -> F64:
    commands = Commands(solver.medium.gpu)
    eye = np.array(camera.position)
    solver.encode(commands, Illumination((), SKY, eye, look=Look(camera, 1.5)))
    commands.submit()
    return solver.emission.texture.read()[..., :3].astype(np.float64) * solver.scale


def test_few_ordinates_are_nearer_to_many(gpu):
    many = emission(gpu, 128)
    none, view = (
        np.linalg.norm(emission(gpu, 12, importance=way) - many) / np.linalg.norm(many)
        for way in ("none", "view")
    )
    assert view < 0.9 * none, (view, none)


def test_a_frame_does_not_remember(gpu):
    """Looked at from elsewhere in between: the same bits."""
    solver = PopSolver(gpu, BALL, PopSettings(ordinates=8, grid=6, importance="view"))
    first = look_at(solver, CAMERA)
    other = look_at(solver, Camera((4.0, 0.0, 2.0), (0.0, 0.0, 0.0)))
    assert not np.array_equal(first, other)
    assert np.array_equal(first, look_at(solver, CAMERA))


def test_a_slow_camera_does_not_flicker(gpu):
    """Half the turn is half the change, and no step is far from the mean one."""
    solver = PopSolver(gpu, BALL, PopSettings(ordinates=16, grid=6, importance="view"))
    frames = []
    for k in range(7):
        angle = np.radians(0.5 * k)
        eye = (float(5.0 * np.sin(angle)), 0.4, float(5.0 * np.cos(angle)))
        frames.append(look_at(solver, Camera(eye, (0.0, 0.0, 0.0), fov_y_deg=40.0)))
    mean = np.mean(frames)
    one, two = (
        np.abs(np.array(frames[k:]) - frames[:-k]).mean(axis=(1, 2, 3, 4)) / mean for k in (1, 2)
    )
    assert one.max() < 0.05
    assert one.max() < 0.75 * two.max()
    assert one.max() < 2.0 * one.mean() + 1e-3


def test_importance_turns_with_the_map_and_the_camera():
    """A map turned with camera and medium sees the same."""
    angle = 30.0
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.eye(4)
    turn[:3, :3] = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    there = Volume((4.0,) * 3, shape="sphere", g=(0.9,) * 3, world_from_volume=turn)
    eye = turn[:3, :3] @ np.array(CAMERA.position)
    camera = Camera(tuple(float(v) for v in eye), (0.0, 0.0, 0.0), fov_y_deg=40.0)
    straight = ViewImportance().of(BALL, placed(BALL, 8), Look(CAMERA, 1.5), 0.0)
    turned = ViewImportance().of(there, placed(there, 8), Look(camera, 1.5), angle)
    np.testing.assert_allclose(turned, straight, rtol=0.1, atol=0.02 * straight.max())
    behind = latlong_texel_directions(16, 32) @ np.array([0.0, 0.0, -1.0]) > 0.95
    assert straight[behind].mean() > 4.0
    away = ViewImportance().of(BALL, placed(BALL, 8), Look(Camera((0, 0, 5), (0, 0, 9)), 1.5), 0.0)
    assert np.array_equal(away, np.ones((16, 32)))


def test_the_coarse_medium_has_the_mediums_mass():
    rho = np.random.default_rng(3).random((20, 30, 10)).astype(np.float32)
    volume = Volume((2.0, 4.0, 6.0), rho, bounds=((0, 0, 0), (1, 3, 2)), g=(0.1, 0.2, 0.3))
    air = coarse_medium(volume, placed(volume, 10))
    assert air.density.mean() == pytest.approx(rho.mean(), rel=0.02)
    assert (air.sigma_t[0], air.g[0]) == (pytest.approx(4.0), pytest.approx(0.2))
