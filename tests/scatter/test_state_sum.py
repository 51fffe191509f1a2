"""Sums over iterations, with corrections by regions and without."""

from functools import cache

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.memory import Buffer
from airlight.maths import lattice26
from airlight.scatter.schedule import schedule
from airlight.scatter.state_sum import LatticeKind, StateSum

COUNT = (8, 6, 7)
SHAPE = COUNT[::-1]
SIGMA_T = np.array([0.1, 0.6, 2.5])
ALBEDO = np.array([1.0, 0.9, 0.5])


def solved(gpu, commands, lattice, source, plan, sigma_s, sigma_t, **kind):
    count = source.shape[1:4][::-1]
    states = StateSum(
        gpu, count, 1.0, plan, LatticeKind(has_walls=False, is_varied=sigma_s.ndim > 1, **kind)
    )
    if sigma_s.ndim > 1:
        states.set_varied(lattice(np.stack([sigma_s, sigma_t], axis=-1)))
    else:
        states.set_homogeneous(sigma_s, sigma_t)
    _, track = states.encode(commands, lattice(source))
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
    plan = schedule("none", iterations)
    got = solved(gpu, commands, lattice, source, plan, ALBEDO * SIGMA_T, SIGMA_T)
    want = summed(iterations)
    np.testing.assert_allclose(got, want, atol=2e-5 * want.max())


def test_no_iterations_are_no_light(gpu, commands, lattice):
    plan = schedule("none", 0)
    assert not solved(gpu, commands, lattice, sparks(), plan, SIGMA_T, SIGMA_T).any()


@pytest.mark.parametrize("is_varied", [False, True])
def test_regions_lead_to_the_same_field_faster(gpu, commands, lattice, is_varied):
    source = sparks()
    want = summed(100)[..., 0]
    plain = summed(9)[..., 0]
    air = [
        np.broadcast_to(v.reshape(3, 1, 1, 1), source.shape[:-1]) if is_varied else v
        for v in (ALBEDO * SIGMA_T, SIGMA_T)
    ]
    plan = schedule("regions", 8)
    got = solved(gpu, commands, lattice, source, plan, *air)[..., 0]
    error, before = (
        np.linalg.norm((v - want).reshape(3, -1), axis=1)
        / np.linalg.norm(want.reshape(3, -1), axis=1)
        for v in (got, plain)
    )
    assert np.all(error < np.maximum(0.55 * before, 0.02)), (error, before)


@pytest.mark.parametrize("is_varied", [False, True])
def test_steps_replayed_follow_light_and_air(gpu, commands, lattice, owned, is_varied):
    # Solved again and again by one, and each time by a fresh one.
    plan = schedule("regions", 4)
    states = owned(
        StateSum(gpu, COUNT, 1.0, plan, LatticeKind(has_walls=False, is_varied=is_varied))
    )
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
            states.set_varied(lattice(np.stack([sigma_s, sigma_t], axis=-1)))
        else:
            states.set_homogeneous(sigma_s, sigma_t)
        _, track = states.encode(commands, source)
        commands.submit()
        want = solved(gpu, Commands(gpu), lattice, given, plan, sigma_s, sigma_t)
        np.testing.assert_array_equal(track.read().reshape(want.shape), want)
