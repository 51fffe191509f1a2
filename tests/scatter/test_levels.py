"""Sums over iterations, coarse corrections, and what energy may do."""

from functools import cache

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.memory import Buffer
from airlight.maths import lattice26, lattice26_levels, lattice26_walls
from airlight.scatter.level import LatticeKind
from airlight.scatter.levels import Levels
from airlight.scatter.schedule import Schedule, schedule

from .test_propagate import HOP_NUMBERS, packed_faces  # type: ignore[import-not-found]

COUNT = (8, 6, 7)
SHAPE = COUNT[::-1]
SIGMA_T = np.array([0.1, 0.6, 2.5])
ALBEDO = np.array([1.0, 0.9, 0.5])


def solved(gpu, commands, lattice, source, plan, sigma_s, sigma_t, **kind):
    count = source.shape[1:4][::-1]
    levels = Levels(
        gpu, count, 1.0, plan, LatticeKind(has_walls=False, is_varied=sigma_s.ndim > 1, **kind)
    )
    if sigma_s.ndim > 1:
        levels.set_varied(commands, lattice(np.stack([sigma_s, sigma_t], axis=-1)))
    else:
        levels.set_homogeneous(sigma_s, sigma_t)
    _, track = levels.encode(commands, lattice(source))
    commands.submit()
    return track.read().reshape(source.shape)


def sparks(shape=SHAPE):
    source = np.zeros((3, *shape, 4))
    source[..., 0] = np.random.default_rng(4).random((3, *shape)) ** 8
    return source


@cache
def summed(iterations):
    """Tracks of the first iterations' states of `sparks`, by NumPy."""
    state = sparks()
    s, t = (v.reshape(3, 1, 1, 1) for v in (ALBEDO * SIGMA_T, SIGMA_T))
    total = np.zeros_like(state)
    for _ in range(iterations):
        state, _, track = lattice26.half_linear_step(state, s, t, 1.0)
        total += track
    return total


@pytest.mark.parametrize("iterations", [1, 2, 7])
def test_the_track_of_the_sum_is_the_sum_of_tracks(gpu, commands, lattice, iterations):
    source = sparks()
    plan = schedule("none", iterations, COUNT)
    got = solved(gpu, commands, lattice, source, plan, ALBEDO * SIGMA_T, SIGMA_T)
    want = summed(iterations)
    np.testing.assert_allclose(got, want, atol=2e-5 * want.max())


def test_no_iterations_are_no_light(gpu, commands, lattice):
    plan = schedule("none", 0, COUNT)
    assert not solved(gpu, commands, lattice, sparks(), plan, SIGMA_T, SIGMA_T).any()


@pytest.mark.parametrize("acceleration", ["finish", "cycle"])
@pytest.mark.parametrize("is_varied", [False, True])
def test_corrections_lead_to_the_same_field_faster(gpu, commands, lattice, acceleration, is_varied):
    source = sparks()
    want = summed(100)[..., 0]
    plain = summed(9)[..., 0]
    air = [
        np.broadcast_to(v.reshape(3, 1, 1, 1), source.shape[:-1]) if is_varied else v
        for v in (ALBEDO * SIGMA_T, SIGMA_T)
    ]
    plan = schedule(acceleration, 8, COUNT)
    got = solved(gpu, commands, lattice, source, plan, *air)[..., 0]
    error, before = (
        np.linalg.norm((v - want).reshape(3, -1), axis=1)
        / np.linalg.norm(want.reshape(3, -1), axis=1)
        for v in (got, plain)
    )
    assert np.all(error < np.maximum(0.55 * before, 0.02)), (error, before)


def test_cycles_converge_to_the_fine_field(gpu, commands, lattice):
    source = sparks()
    want = summed(100)
    plan = Schedule((1, 1, 8), (1, 1, 0), visits=2, cycles=8)
    got = solved(gpu, commands, lattice, source, plan, ALBEDO * SIGMA_T, SIGMA_T)
    np.testing.assert_allclose(got, want, atol=2e-3 * want.max())


def test_coarse_walls_and_air_are_numpys(gpu, commands, lattice):
    count, shape = (7, 6, 4), (4, 6, 7)  # odd: the last coarse cells are half empty
    rng = np.random.default_rng(8)
    faces = np.round(np.clip(rng.random((6, *shape)) * 2 - 0.5, 0, 1) * 255) / 255
    air = rng.random((3, *shape, 2))
    white = rng.integers(0, 256, (*shape, 4)).astype(np.uint8)
    levels = Levels(
        gpu, count, 1.0, Schedule((1, 1), (0, 0)), LatticeKind(has_walls=True, is_varied=True)
    )
    levels.set_varied(commands, lattice(air))
    levels.set_walls(commands, lattice(packed_faces(faces)), lattice(white.view(np.uint32)))
    commands.submit()
    coarse = levels.levels[1]
    assert coarse.count == (4, 3, 2)
    got = coarse.face_visibility.read(np.uint8).reshape(2, 3, 4, 8)[..., :6] / 255
    want = np.moveaxis(lattice26_levels.restricted_faces(faces), 0, -1)
    # Hops into the lattice from beyond its border carry nothing.
    borders = np.s_[:, :, 0], np.s_[:, :, -1], np.s_[:, 0], np.s_[:, -1], np.s_[0], np.s_[-1]
    for k, border in enumerate(borders):
        want[..., k][border] = got[..., k][border]
    np.testing.assert_allclose(got, want, atol=0.51 / 255)
    medium = coarse.medium.read().reshape(3, 2, 3, 4, 2)
    np.testing.assert_allclose(medium, lattice26_levels.restricted(air, is_mean=True), rtol=1e-5)
    packs = coarse.packs.read(np.uint8).reshape(2, 3, 4, 4, 16)
    outgoing = packs[..., 2:, :].reshape(2, 3, 4, 32)[..., HOP_NUMBERS] / 255
    exact = lattice26_walls.open_hops(np.moveaxis(got, -1, 0))
    np.testing.assert_allclose(outgoing, np.moveaxis(exact, 0, -1), atol=0.51 / 255)
    mean = packs[:, :, 0, 3, 12:15].astype(float)
    fine = white[..., :3].astype(float)[:, :, :2].reshape(2, 2, 3, 2, 2, 3).mean(axis=(1, 3, 4))
    np.testing.assert_allclose(mean, fine, atol=0.51)


@pytest.mark.parametrize("is_varied", [False, True])
def test_cycles_replayed_follow_light_and_air(gpu, commands, lattice, owned, is_varied):
    # Solved again and again by one, and each time by a fresh one.
    plan = schedule("cycle", 4, COUNT)
    levels = owned(Levels(gpu, COUNT, 1.0, plan, LatticeKind(has_walls=False, is_varied=is_varied)))
    source = owned(Buffer(gpu, "source", 3 * np.prod(COUNT) * 16))
    for factor, light in ((1.0, 1.0), (1.0, 3.0), (0.5, 3.0)):
        sigma_t = factor * SIGMA_T
        if is_varied:
            sigma_t = (
                sigma_t[:, None, None, None] * np.linspace(0.5, 1.5, COUNT[0]) * np.ones(SHAPE)
            )
        sigma_s = sigma_t * ALBEDO.reshape(3, *[1] * (sigma_t.ndim - 1))
        given = light * sparks()
        source.write(given.astype(np.float32))
        if is_varied:
            levels.set_varied(commands, lattice(np.stack([sigma_s, sigma_t], axis=-1)))
        else:
            levels.set_homogeneous(sigma_s, sigma_t)
        _, track = levels.encode(commands, source)
        commands.submit()
        want = solved(gpu, Commands(gpu), lattice, given, plan, sigma_s, sigma_t)
        np.testing.assert_array_equal(track.read().reshape(want.shape), want)
