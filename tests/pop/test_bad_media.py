"""Media at the edge of sense: a message or an image, never a black or exploding one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.errors import AirlightError, SceneError
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths.transforms import F64
from airlight.pop.light.illumination import Illumination
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.rendering import Renderer
from airlight.scene import Camera, DirectionalLight, Environment, PointLight, Scene, Volume

SETTINGS = PopSettings(ordinates=6, grid=5, solver_steps=8)
EYE = np.array([3.0, 1.0, 2.0])
ONES = np.ones((4, 4, 4), np.float32)


def emission(gpu: Gpu, volume: Volume) -> F64:
    """Under a uniform sky of radiance 1, a sun and a lamp inside."""
    solver, commands = PopSolver(gpu, volume, SETTINGS, lights=2), Commands(gpu)
    lights = (DirectionalLight((0, -1, 0), (1, 1, 1)), PointLight((0.1, 0.2, 0.3), (0.1, 0.1, 0.1)))
    solver.encode(commands, Illumination(lights, Environment((1.0, 1.0, 1.0)), EYE))
    commands.submit()
    texels = solver.emission.texture.read()[..., :3].astype(np.float64)
    return np.asarray(texels * solver.scale)


@pytest.mark.parametrize(
    "sigma_t", [0.0, 1e-30, *(pytest.param(s, marks=pytest.mark.slow) for s in (1e-6, 1e4)), 1e12]
)
@pytest.mark.parametrize("g", [-0.999, 0.0, 0.999])
def test_any_extinction_and_g_scatter_a_finite_light(gpu, sigma_t, g):
    volume = Volume((sigma_t,) * 3, ONES, g=(g,) * 3, albedo=(1.0, 0.5, 0.0))
    got = emission(gpu, volume)
    assert np.isfinite(got).all()
    assert got.min() >= 0.0
    # A lamp inside is seen by its own reflection, which g = -.999 makes a point of 1e5.
    assert 0.0 < got[..., 0].mean() < (100.0 if g >= 0.0 else 1e4)


@pytest.mark.parametrize(
    "density",
    [
        np.zeros((4, 4, 4)),
        np.ones((1, 1, 1)),
        np.ones((1, 9, 9)),
        np.full((2, 2, 2), 1e-30),
        np.full((2, 2, 2), 1e15),
        np.pad(np.ones((1, 1, 1)), 4),
        np.ones((2, 2, 300)),
    ],
    ids=[
        "empty air",
        "one voxel",
        "one voxel thin",
        "next to nothing",
        "beyond half floats",
        "a speck",
        "a line",
    ],
)
def test_any_density_gives_a_finite_light(gpu, density):
    got = emission(gpu, Volume((2.0,) * 3, density.astype(np.float32), g=(0.0, 0.9, -0.9)))
    assert np.isfinite(got).all()
    assert got.max() < 100.0


def test_boxes_of_any_size_and_form(gpu):
    for bounds in (
        ((0, 0, 0), (1e-4, 1e-4, 1e-4)),
        ((-1e5,) * 3, (1e5,) * 3),
        ((0, 0, 0), (100.0, 0.01, 1.0)),
    ):
        assert np.isfinite(emission(gpu, Volume((1.0,) * 3, ONES, bounds=bounds))).all()
    flat = np.diag([1.0, 1e-6, 1.0, 1.0])
    assert np.isfinite(emission(gpu, Volume((1.0,) * 3, ONES, world_from_volume=flat))).all()


@pytest.mark.parametrize(
    ("fields", "problem"),
    [
        ({"density": ONES * np.nan}, "volume density has 64 values that are NaN or infinite"),
        ({"density": ONES * np.inf}, "volume density has 64 values that are NaN or infinite"),
        ({"density": -ONES}, "volume density is negative (down to -1)"),
        ({"density": np.ones((0, 2, 2), np.float32)}, "volume density is empty"),
        ({"density": np.ones((4, 4), np.float32)}, "volume density has shape (4, 4)"),
        ({"g": (1.0, 0.0, 0.0)}, "g = [1.0, 0.0, 0.0] must lie in (-1, 1)"),
        ({"g": -1.5}, "must lie in (-1, 1)"),
        ({"sigma_t": (1.0, 2.0)}, "sigma_t must be three numbers"),
        ({"sigma_t": (1.0, 2.0, float("nan"))}, "sigma_t is nan, it must be finite"),
        ({"albedo": 1.5}, "albedo = [1.5, 1.5, 1.5] is above 1"),
        ({"bounds": ((0, 0, 0), (1, 0, 1))}, "volume bounds is empty"),
        ({"density": None, "shape": "box", "detail": 1.0}, "a shape has none"),
    ],
)
def test_what_makes_no_sense_is_refused(fields, problem):
    with pytest.raises(SceneError) as caught:
        dataclasses.replace(Volume((1.0,) * 3, ONES), **fields)
    assert problem in str(caught.value)


def test_a_grid_longer_than_the_device_takes_is_refused_in_words(gpu):
    side = int(gpu.limits["max-texture-dimension-3d"]) + 1
    long = Volume((1.0,) * 3, np.ones((1, 1, side), np.float32))
    scene = Scene(volumes=(long,), camera=Camera((0, 0, 4), (0, 0, 0)))
    with pytest.raises(AirlightError, match="do not fit into one texture of"):
        Renderer(scene, "pop", (8, 8))


@pytest.mark.parametrize("g", [0.0, 0.9])
def test_a_white_block_is_white_however_thick(gpu, g):
    for sigma_t in (8.0, 80.0, 1e6):
        block = Volume((sigma_t,) * 3, ONES, g=(g,) * 3, albedo=(1.0, 0.9, 0.5))
        solver, commands = PopSolver(gpu, block, PopSettings(ordinates=16, grid=8)), Commands(gpu)
        solver.encode(commands, Illumination((), Environment((1.0, 1.0, 1.0)), EYE))
        commands.submit()
        side = solver.emission.texture.read()[:, :, -1, :3].astype(np.float64).mean(axis=(0, 1))
        side *= solver.scale
        assert side[0] == pytest.approx(1.0, abs=0.06)
        assert 0.05 < side[1] < 0.7
        assert 0.01 < side[2] < 0.3
