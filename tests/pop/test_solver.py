"""Every pass of the solver against its NumPy twin, and what must not change from run to run."""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import numpy as np
import pytest
from scipy.ndimage import maximum_filter

from airlight.errors import SceneError
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths import delta_beam as db
from airlight.maths.ordinates import Ordinates, uniform_sky
from airlight.maths.point_light_beam import axis_share, near_fluence, point_light_beam
from airlight.maths.transforms import F64
from airlight.maths.voxels import box_averaged
from airlight.pop.light.illumination import Illumination
from airlight.pop.light.ordinates import SceneOrdinates
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.scene.environment import Environment
from airlight.scene.lights import DirectionalLight, Light, PointLight, SpotLight
from airlight.scene.volume import Volume

SKY, SUN = Environment((0.2, 0.3, 0.4)), DirectionalLight((0.3, -0.8, 0.2), (3.0, 2.0, 1.0))
EYE = np.array([3.0, 1.0, 2.0])
SETTINGS = PopSettings(ordinates=8, grid=8, solver_steps=24, exact_sky=False)


def blob(side: int = 20) -> Volume:
    at = (np.arange(side) + 0.5) / side - 0.5
    radius = np.sqrt(at[:, None, None] ** 2 + at[:, None] ** 2 + at**2)
    noise = np.random.default_rng(1).random(radius.shape)
    rho = (np.clip((0.3 - radius) / 0.15, 0.0, 1.0) * (0.5 + noise)).astype(np.float32)
    turn = np.array([[0.6, 0, 0.8, 0.1], [0, 1, 0, 0.2], [-0.8, 0, 0.6, 0.3], [0, 0, 0, 1.0]])
    return Volume(
        (4.0, 8.0, 12.0),
        rho,
        bounds=((-1, -0.5, -1.5), (1, 1, 1)),
        albedo=(1.0, 0.9, 0.8),
        g=(0.0, 0.6, 0.9),
        world_from_volume=turn,
    )


class Twin(NamedTuple):
    """The NumPy solution of a solver's medium under some ordinates."""

    medium: db.MediumGrid
    solution: db.Solution
    towards_eye: F64


def twin(solver: PopSolver, sky: Ordinates, scale: float, *, is_white: bool = False) -> Twin:
    v, at = solver.medium.volume, solver.medium.placement
    assert v.density is not None
    fine = box_averaged(v.density, at.fine_count)
    x, y, z = at.count
    coarse = fine.reshape(z, 2, y, 2, x, 2).mean(axis=(1, 3, 5))
    albedo = np.ones(3) if is_white else np.array(v.albedo)
    air = db.MediumGrid(at.extent, coarse, fine, np.array(v.sigma_t), albedo, np.array(v.g))
    rows = zip(at.direction(sky.direction), sky.irradiance / scale, sky.mean_cosine, strict=True)
    beams = [db.beam(air, *row) for row in rows]
    solution = db.light(
        air,
        beams,
        SETTINGS.solver_steps,
        solver.medium.placed.width.diffusivity,
        solver.medium.placed.width.density,
    )
    away = at.point(EYE) - air.centres
    return Twin(air, solution, away / np.linalg.norm(away, axis=-1, keepdims=True))


@pytest.fixture(scope="module")
def solved(gpu: Gpu) -> PopSolver:
    solver = PopSolver(gpu, blob(), SETTINGS, lights=1)
    commands = Commands(gpu)
    solver.encode(commands, Illumination((SUN,), SKY, EYE))
    commands.submit()
    return solver


@pytest.fixture(scope="module")
def truth(solved: PopSolver) -> Twin:
    sky = SceneOrdinates(SETTINGS.ordinates).of((SUN,), SKY)
    return twin(solved, sky, solved.scale)


def of_cells(solver: PopSolver, buffer: np.ndarray, parts: int) -> F64:
    x, y, z = solver.medium.placement.count
    return np.asarray(buffer.reshape(parts, z, y, x, 4)[..., :3], dtype=np.float64)


def assert_close(got: F64, want: F64, share: float) -> None:
    assert np.abs(got - want).max() < share * np.abs(want).max()


def test_density_is_averaged(solved, truth):
    x, y, z = solved.medium.placement.count
    got = solved.medium.density.cells.read().reshape(z, y, x)
    assert_close(got, truth.medium.density, 2e-3)
    assert_close(solved.medium.density.fine.read()[..., 0], truth.medium.fine, 2e-3)


def test_paths_are_marched(solved, truth):
    want = np.stack([b.passed for b in truth.solution.beams])
    got = solved.transport.light.passed.read()[: want.size].reshape(want.shape)
    asked = reached(truth)
    assert 0.3 < asked.mean() < 1.0
    assert_close(got * asked, want * asked, 3e-3)
    assert got[:, ~asked].max(initial=0.0) == 0.0


def reached(truth: Twin) -> np.ndarray:
    """Cells from which filtering can see the medium."""
    return np.asarray(maximum_filter(truth.medium.density, 3, mode="nearest") > 0.0)


def test_deposits_are_left(solved, truth):
    power, forward = db.deposit(truth.medium, truth.solution.beams)
    got = of_cells(solved, solved.transport.diffuse.deposits.read(), 4)
    assert_close(got[0], power, 2e-3)
    assert_close(got[1:], forward, 2e-3)


def test_light_diffuses(solved, truth):
    got = of_cells(solved, solved.transport.diffuse.diffuse.read(), 7)
    assert_close(got[0], truth.solution.fluence, 3e-3)
    assert_close(got[1:4], truth.solution.flux, 3e-3)
    residual = of_cells(solved, solved.transport.diffuse.residual.read(), 1)
    power, _ = db.deposit(truth.medium, truth.solution.beams)
    source = power / np.prod(truth.medium.cell)
    assert np.linalg.norm(residual) < 5e-3 * np.linalg.norm(source)


def test_emission_and_its_furnace_correction(solved, truth):
    white = twin(solved, uniform_sky(SETTINGS.ordinates), 1.0, is_white=True)
    beams, quasi = white.solution.beam_emission(white.towards_eye)
    multiple = quasi + white.solution.diffuse_emission(white.towards_eye)
    correction = np.clip((1.0 - beams) / np.maximum(multiple, 1e-6), 0.5, 2.0)
    got = of_cells(solved, solved.emission.corrections.read(), 1)[0]
    asked = reached(truth)[..., None]
    assert np.abs((got - correction) * asked).mean() < 2e-3
    beams, quasi = truth.solution.beam_emission(truth.towards_eye)
    want = beams + (quasi + truth.solution.diffuse_emission(truth.towards_eye)) * correction
    emission = solved.emission.texture.read()[..., :3].astype(np.float64)
    assert_close(emission, want * asked, 5e-3)


def test_the_source_is_in_world_units(solved):
    (source,) = solved.sources(2)
    assert source.medium == 2
    assert source.scale == pytest.approx(3.0)
    centre = source.uvw_from_world @ np.array([*solved_centre(solved.medium.volume), 1.0])
    np.testing.assert_allclose(centre[:3], 0.5)


def solved_centre(volume: Volume) -> F64:
    centre = np.mean(volume.bounds, axis=0)
    return np.asarray(volume.world_from_volume[:3, :3] @ centre + volume.world_from_volume[:3, 3])


def frame(
    solver: PopSolver,
    gpu: Gpu,
    lights: tuple[Light, ...],
    sky: Environment | None,
    eye: F64,
    volume: Volume | None = None,
) -> F64:
    commands = Commands(gpu)
    texture = solver.encode(commands, Illumination(lights, sky, eye), volume)
    commands.submit()
    return texture.read().astype(np.float64)


def test_frames_repeat_to_the_bit_and_follow_every_change(gpu):
    one, two = (PopSolver(gpu, blob(8), SETTINGS, lights=1) for _ in range(2))
    first = frame(one, gpu, (SUN,), SKY, EYE)
    assert np.array_equal(first, frame(two, gpu, (SUN,), SKY, EYE))
    assert np.array_equal(first, frame(one, gpu, (SUN,), SKY, EYE))
    moved = frame(one, gpu, (SUN,), SKY, -EYE)
    assert not np.array_equal(first, moved)
    assert np.array_equal(frame(two, gpu, (SUN,), SKY, -EYE), moved)
    dimmer = DirectionalLight(SUN.direction, (1.0, 1.0, 1.0))
    assert not np.array_equal(frame(one, gpu, (dimmer,), SKY, -EYE), moved)
    thinner = dataclasses.replace(one.medium.volume, density=0.5 * one.medium.volume.density)
    changed = frame(one, gpu, (SUN,), SKY, EYE, thinner)
    fresh = PopSolver(gpu, thinner, SETTINGS, lights=1)
    assert np.array_equal(changed, frame(fresh, gpu, (SUN,), SKY, EYE))
    with pytest.raises(SceneError, match=r"the volume changed in size\. Make a new Renderer"):
        one.encode(Commands(gpu), Illumination((SUN,), SKY, EYE), blob(9))


@pytest.mark.parametrize("density", [np.zeros((4, 4, 4)), np.ones((1, 1, 1)), np.ones((1, 30, 2))])
def test_empty_and_tiny_volumes_stay_finite(gpu, density):
    volume = Volume((5.0,) * 3, density.astype(np.float32), g=(0.99, -0.9, 0.0))
    got = frame(PopSolver(gpu, volume, SETTINGS, lights=1), gpu, (SUN,), SKY, EYE)
    assert np.isfinite(got).all()
    dark = PopSolver(gpu, volume, SETTINGS)
    assert frame(dark, gpu, (), None, EYE)[..., :3].max() == 0.0


LIGHTS = (
    PointLight((0.3, 0.4, 0.5), (2.0, 1.0, 0.5), radius=0.2),
    SpotLight((2.5, 1.5, 2.0), (-0.6, -0.3, -0.5), (30.0, 20.0, 10.0), 15.0, 30.0),
)


def test_a_spot_that_turns_its_back_scatters_nothing(gpu):
    """However near by: its light is all around it to no one."""
    low = blob().bounds[0][1]
    seen = []
    for sign in (1.0, -1.0):
        spot = SpotLight((0.0, low - 0.05, 0.0), (0.0, sign, 0.0), (1.0,) * 3, 20.0, 30.0)
        solver = PopSolver(gpu, blob(), SETTINGS, lights=1)
        seen.append(frame(solver, gpu, (spot,), None, EYE)[..., :3].astype(np.float64).sum())
    assert seen[1] < 1e-4 * seen[0]


def test_local_lights_reach_the_medium_like_their_twins(gpu):
    settings = dataclasses.replace(SETTINGS, furnace_correction=0.0)
    solver = PopSolver(gpu, blob(), settings, lights=2)
    commands = Commands(gpu)
    solver.encode(commands, Illumination(LIGHTS, None, EYE))
    commands.submit()
    at, scale, width = (
        solver.medium.placement,
        solver.scale,
        solver.medium.placed.width,
    )
    air = twin(solver, uniform_sky(1), scale).medium
    beams, near = [], 0.0
    for light in LIGHTS:
        position = at.point(np.array(light.position))
        away = air.centres - position
        distance = np.linalg.norm(away, axis=-1)
        intensity = np.array(light.intensity) / scale
        mean, beside = intensity, np.ones(())
        by_cell = np.broadcast_to(intensity, (*air.density.shape, 3))
        if isinstance(light, SpotLight):
            inner, outer = np.cos(np.radians([light.inner_deg, light.outer_deg]))
            axis = at.direction(np.array(light.direction))
            t = np.clip(((away / distance[..., None]) @ axis - outer) / (inner - outer), 0, 1)
            by_cell = intensity * (t * t * (3 - 2 * t))[..., None]
            mean = intensity * (0.5 - 0.25 * (inner + outer))
            beside = axis_share(position, axis, air.extent, air.centres)
        spread = light.radius if isinstance(light, PointLight) else 0.0
        one = point_light_beam(air, position, by_cell, mean, spread)
        beams.append(one)
        radius = 3.0 * width.diffusivity
        around = near_fluence(air, one, distance, mean, radius, width.density)
        near = near + beside[..., None] * around
    solution = db.light(air, beams, SETTINGS.solver_steps, width.diffusivity)
    got = of_cells(solver, solver.transport.diffuse.diffuse.read(), 7)
    assert_close(got[0], np.maximum(solution.fluence + near, 0.0), 5e-3)
    assert_close(got[1:4], solution.flux, 5e-3)
    # Towards the eye, with what beams and diffusion miss close to the lights.
    whole = dataclasses.replace(solution, fluence=np.maximum(solution.fluence + near, 0.0))
    towards = at.point(EYE) - air.centres
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    want = whole.emission(towards)
    emission = solver.emission.texture.read()[..., :3].astype(np.float64)
    asked = emission.sum(axis=-1, keepdims=True) > 0.0
    assert asked.mean() > 0.1
    assert_close(emission, want * asked, 5e-3)
