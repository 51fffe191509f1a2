"""Steps through air that varies, against NumPy and against the homogeneous kernel."""

import numpy as np
import pytest

from airlight.maths import lattice26, lattice26_walls
from airlight.scatter.propagate import MOVE, TRACK
from airlight.scatter.propagate_varied import VariedStep

from .test_propagate import (  # type: ignore[import-not-found]
    CELL_M,
    COUNT,
    SIGMA_S,
    SIGMA_T,
    WHITE,
    random_state,
    stepped,
    walls,  # noqa: F401
)


def varied(gpu, lattice, commands, state, sigma_s, sigma_t, packs=None):
    """(state, track) of the kernel."""
    medium = lattice(np.stack(np.broadcast_arrays(sigma_s, sigma_t), axis=-1))
    before, source = lattice(state), lattice(np.zeros_like(state))
    step = VariedStep(gpu, is_blocked=packs is not None)
    got = []
    for is_track in (False, True):
        after = lattice(state)
        step.encode(
            commands,
            COUNT,
            CELL_M,
            medium,
            is_track=is_track,
            before=before,
            source=source,
            after=after,
            packs=packs or before,
        )
        commands.submit()
        got.append(after.read().reshape(state.shape))
    return got


def random_medium(state, seed=3):
    rng = np.random.default_rng(seed)
    sigma_t = 10.0 ** rng.uniform(-3, 1, state.shape[:-1])
    sigma_t[..., :2] = 0.0
    return rng.random(state.shape[:-1]) * sigma_t, sigma_t


@pytest.mark.parametrize("is_blocked", [False, True])
def test_the_step_is_numpys(gpu, lattice, commands, walls, is_blocked):  # noqa: F811
    packs, face_visibility, _, _ = walls
    state = random_state()
    sigma_s, sigma_t = random_medium(state)
    blocked = 1.0 - face_visibility if is_blocked else None
    after, _, track = lattice26.half_linear_step(state, sigma_s, sigma_t, CELL_M, blocked)
    if is_blocked:
        white = np.round(WHITE * 255).reshape(3, 1, 1, 1) / 255.0
        back = lattice26_walls.bounced(state, sigma_s, sigma_t, CELL_M, blocked, white)
        after, track = after + back[0], track + back[1]
    got = varied(gpu, lattice, commands, state, sigma_s, sigma_t, packs if is_blocked else None)
    for value, expected in zip(got, (after, track), strict=True):
        np.testing.assert_allclose(value, expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("is_blocked", [False, True])
def test_constant_air_is_the_homogeneous_step(gpu, lattice, commands, walls, is_blocked):  # noqa: F811
    packs = walls[0] if is_blocked else None
    state = random_state(2)
    constant = [
        np.broadcast_to(v.reshape(3, 1, 1, 1), state.shape[:-1]) for v in (SIGMA_S, SIGMA_T)
    ]
    got = varied(gpu, lattice, commands, state, *constant, packs)
    for value, row in zip(got, (MOVE, TRACK), strict=True):
        expected = stepped(gpu, lattice, commands, state, row, packs)
        np.testing.assert_allclose(value, expected, atol=2e-5 * np.abs(expected).max())
