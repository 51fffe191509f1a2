"""What light in a lattice may never do, whatever the air and the walls."""

import numpy as np
import pytest

from airlight.gpu.layout import pack_array
from airlight.scatter.coefficients import StepCoefficients, step_rows
from airlight.scatter.propagate import Operator, Step, StepMedium

from .test_propagate import (  # type: ignore[import-not-found]
    COUNT,
    SHAPE,
    random_state,
    walls,  # noqa: F401
)


def run(gpu, lattice, commands, state, sigma_s, sigma_t, steps, packs=None, is_varied=False):
    """The states after each of `steps` iterations in cells of 1 m."""
    source, buffers = lattice(np.zeros_like(state)), [lattice(state), lattice(np.zeros_like(state))]
    rows = pack_array(StepCoefficients, step_rows(sigma_s, sigma_t, 1.0))
    shape = state.shape[:-1]
    sigmas = [np.broadcast_to(np.reshape(v, (3, 1, 1, 1)), shape) for v in (sigma_s, sigma_t)]
    medium = lattice(np.stack(sigmas, axis=-1))
    cells = StepMedium(COUNT, 1.0, medium, lattice(rows.view(np.uint32)), packs or source)
    step = Step(gpu, has_walls=packs is not None, is_varied=is_varied)
    seen = []
    for _ in range(steps):
        before, after = buffers
        step.encode(commands, cells, Operator.MOVE, before=before, source=source, after=after)
        commands.submit()
        buffers.reverse()
        seen.append(buffers[0].read().reshape(state.shape).astype(np.float64))
    return seen


def test_without_walls_and_absorption_power_is_kept_until_it_reaches_the_border(
    gpu, lattice, commands
):
    state = np.zeros((3, *SHAPE, 4))
    state[:, 5, 2, 3] = [2.0, 0.5, -1.0, 0.3]
    for sigma in (0.0, 0.3, 10.0):
        after = run(gpu, lattice, commands, state, [sigma] * 3, [sigma] * 3, 1)[0]
        np.testing.assert_allclose(after[..., 0].sum(axis=(1, 2, 3)), 2.0, rtol=1e-6)


@pytest.mark.parametrize("is_varied", [False, True])
@pytest.mark.parametrize("albedo", [0.0, 0.5, 1.0])
def test_no_air_makes_light_negative_or_grow(gpu, lattice, commands, albedo, is_varied):
    sigma_t = np.array([0.01, 1.0, 10.0])
    state = np.abs(random_state(5))
    state[..., 1:] = 0.0
    start = before = state[..., 0].sum(axis=(1, 2, 3))
    for after in run(
        gpu, lattice, commands, state, albedo * sigma_t, sigma_t, 24, is_varied=is_varied
    ):
        power = after[..., 0].sum(axis=(1, 2, 3))
        assert np.isfinite(after).all()
        # A two-band wave leaves a trough of under a percent behind as the last of it goes out.
        assert np.all(power <= before + 0.01 * start), (power, before)
        assert np.all(power >= -0.01 * start)
        before = np.maximum(power, 0.0)


@pytest.mark.parametrize("is_varied", [False, True])
@pytest.mark.parametrize("albedo", [0.3, 1.0])
def test_walls_never_add_light(gpu, lattice, commands, walls, albedo, is_varied):  # noqa: F811
    """Not even where two-band lobes send negative power into them."""
    packs, *_ = walls
    sigma_t = np.array([0.0, 0.4, 5.0])
    state = random_state(6)
    start = before = state[..., 0].sum(axis=(1, 2, 3))
    for after in run(
        gpu, lattice, commands, state, albedo * sigma_t, sigma_t, 16, packs, is_varied
    ):
        power = after[..., 0].sum(axis=(1, 2, 3))
        assert np.isfinite(after).all()
        assert np.all(power <= before + 1e-5 * np.abs(start)), (power, before)
        before = power
