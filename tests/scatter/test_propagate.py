"""The device's step against the NumPy truth: media, walls, both kernels; energy."""

import numpy as np
import pytest

from airlight.gpu.layout import pack_array
from airlight.maths import lattice26, lattice26_walls
from airlight.scatter.coefficients import StepCoefficients, step_rows
from airlight.scatter.propagate import MOVE, TRACK, Step
from airlight.scatter.walls import Walls, new_packs

pytestmark = pytest.mark.both_paths

COUNT = (6, 4, 10)  # x, y, z: unequal, more than one slab
SHAPE = COUNT[::-1]
CELL_M = 0.7
SIGMA_T = np.array([0.05, 0.8, 4.0])
SIGMA_S = np.array([1.0, 0.9, 0.5]) * SIGMA_T
WHITE = np.array([0.8, 0.4, 0.0])


def random_state(seed: int = 1) -> np.ndarray:
    state = np.random.default_rng(seed).normal(size=(3, *SHAPE, 4))
    state[..., 0] = np.abs(state[..., 0])
    return state


def packed_faces(faces: np.ndarray) -> np.ndarray:
    """(6, Z, Y, X) -> two u32 per cell, and the same as they are after rounding."""
    units = np.round(faces * 255).astype(np.uint8)
    eight = np.concatenate([units, np.full((2, *units.shape[1:]), 255, np.uint8)])
    return np.ascontiguousarray(np.moveaxis(eight, 0, -1)).view(np.uint32)


def unpacked(packs: np.ndarray, first: int) -> np.ndarray:
    """(26, Z, Y, X) open shares of two packs."""
    units = packs.view(np.uint8).reshape(*SHAPE, 4, 16)[..., first : first + 2, :]
    return np.moveaxis(units.reshape(*SHAPE, 32)[..., :26], -1, 0) / 255.0


def reflectance_words() -> np.ndarray:
    rgb = np.round(np.append(WHITE, 0.0) * 255).astype(np.uint8)
    return np.tile(rgb.view(np.uint32), SHAPE)


@pytest.fixture
def walls(gpu, lattice, commands):
    """(packs buffer, blocked shares (26, Z, Y, X)) of random half-open faces."""
    faces = np.random.default_rng(7).random((6, *SHAPE)) * 1.6
    faces = np.clip(faces - 0.3, 0.0, 1.0)
    packs = new_packs(gpu, int(np.prod(SHAPE)))
    Walls(gpu).encode(
        commands, COUNT, lattice(packed_faces(faces)), lattice(reflectance_words()), packs
    )
    commands.submit()
    words = packs.read(np.uint32)
    exact = lattice26_walls.open_hops(np.round(faces * 255) / 255.0)
    yield packs, unpacked(words, 2), exact, unpacked(words, 0)
    packs.release()


def stepped(gpu, lattice, commands, state, row, packs=None, is_marched=False):
    rows = pack_array(StepCoefficients, step_rows(SIGMA_S, SIGMA_T, CELL_M))
    coefficients = lattice(rows.view(np.uint32))
    before, source, after = (lattice(v) for v in (state, np.zeros_like(state), state))
    step = Step(gpu, is_blocked=packs is not None, is_marched=is_marched)
    step.encode(
        commands,
        COUNT,
        coefficients,
        row,
        before=before,
        source=source,
        after=after,
        packs=packs or before,
    )
    commands.submit()
    return after.read().reshape(state.shape)


def truth(state, blocked=None):
    """(state, track) after one iteration: half-linear steps and what walls return."""
    shape = state.shape[:-1]
    s, t = (np.broadcast_to(v.reshape(3, 1, 1, 1), shape) for v in (SIGMA_S, SIGMA_T))
    after, _, track = lattice26.half_linear_step(state, s, t, CELL_M, blocked)
    if blocked is not None:
        white = np.round(WHITE * 255).reshape(3, 1, 1, 1) / 255.0
        back = lattice26_walls.bounced(state, s, t, CELL_M, blocked, white)
        after, track = after + back[0], track + back[1]
    return after, track


@pytest.mark.parametrize("is_marched", [False, True])
def test_the_free_step_is_numpys(gpu, lattice, commands, is_marched):
    state = random_state()
    for row, expected in zip((MOVE, TRACK), truth(state), strict=True):
        got = stepped(gpu, lattice, commands, state, row, is_marched=is_marched)
        np.testing.assert_allclose(got, expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("is_marched", [False, True])
def test_the_step_among_walls_is_numpys(gpu, lattice, commands, walls, is_marched):
    packs, face_visibility, _, _ = walls
    state = random_state()
    for row, expected in zip((MOVE, TRACK), truth(state, 1.0 - face_visibility), strict=True):
        got = stepped(gpu, lattice, commands, state, row, packs, is_marched)
        np.testing.assert_allclose(got, expected, atol=1e-5 * np.abs(expected).max())


def test_visibility_of_hops_is_numpys_and_incoming_is_the_neighbours_outgoing(walls):
    _, outgoing, exact, incoming = walls
    np.testing.assert_allclose(outgoing, exact, atol=0.51 / 255)
    offsets = lattice26.hops().offsets
    for j, (x, y, z) in enumerate(offsets.tolist()):
        back = int(np.flatnonzero((offsets == [-x, -y, -z]).all(axis=1))[0])
        padded = np.pad(outgoing[back], 1, constant_values=1.0)
        nz, ny, nx = SHAPE
        moved = padded[1 + z : 1 + z + nz, 1 + y : 1 + y + ny, 1 + x : 1 + x + nx]
        np.testing.assert_allclose(incoming[j], moved, atol=1e-9)
