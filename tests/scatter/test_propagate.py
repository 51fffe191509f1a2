"""The device's steps against the NumPy truth: media, walls, tracks, and the kernel of rows."""

import numpy as np
import pytest

from airlight.gpu.lanes import has_row_lanes
from airlight.gpu.layout import pack_array
from airlight.maths import lattice26, lattice26_walls
from airlight.scatter.coefficients import (
    StepCoefficients,
    handed_on,
    paper_gain,
    paper_rows,
    step_rows,
)
from airlight.scatter.hop_visibility import HopVisibility, new_packs
from airlight.scatter.propagate import Operator, Step, StepMedium

pytestmark = pytest.mark.both_paths

COUNT = (6, 4, 10)  # x, y, z: unequal, more than one slab
SHAPE = COUNT[::-1]
CELL_M = 0.7
SIGMA_T = np.array([0.05, 0.8, 4.0])
SIGMA_S = np.array([1.0, 0.9, 0.5]) * SIGMA_T
HOP_NUMBERS = lattice26.hops().offsets @ [1, 3, 9] + 13  # wgsl/hops26
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
    return np.moveaxis(units.reshape(*SHAPE, 32)[..., HOP_NUMBERS], -1, 0) / 255.0


def reflectance_words() -> np.ndarray:
    rgb = np.round(np.append(WHITE, 0.0) * 255).astype(np.uint8)
    return np.tile(rgb.view(np.uint32), SHAPE)


@pytest.fixture
def walls(gpu, lattice, commands):
    """(packs buffer, blocked shares (26, Z, Y, X)) of random half-open faces."""
    faces = np.random.default_rng(7).random((6, *SHAPE)) * 1.6
    faces = np.clip(faces - 0.3, 0.0, 1.0)
    packs = new_packs(gpu, int(np.prod(SHAPE)))
    HopVisibility(gpu).encode(
        commands, COUNT, lattice(packed_faces(faces)), lattice(reflectance_words()), packs
    )
    commands.submit()
    words = packs.read(np.uint32)
    exact = lattice26_walls.open_hops(np.round(faces * 255) / 255.0)
    yield packs, unpacked(words, 2), exact, unpacked(words, 0)
    packs.release()


def stepped(
    gpu,
    lattice,
    commands,
    state,
    operator,
    packs=None,
    medium=None,
    has_rows=False,
    *,
    rows=None,
    handed_on=0.0,
):
    """K before, in the homogeneous medium, or in `medium` (sigma_s, sigma_t) (C, Z, Y, X)."""
    if handed_on:
        rows = paper_rows([0.0] * 3, [0.0] * 3, CELL_M)
    rows = pack_array(StepCoefficients, rows or step_rows(SIGMA_S, SIGMA_T, CELL_M))
    before, source, after = (lattice(v) for v in (state, np.zeros_like(state), state))
    varied = None if medium is None else lattice(np.stack(medium, axis=-1))
    step = Step(
        gpu,
        has_walls=packs is not None,
        is_varied=medium is not None,
        handed_on=handed_on,
        has_rows=has_rows,
    )
    cells = StepMedium(
        COUNT, CELL_M, varied or before, lattice(rows.view(np.uint32)), packs or before
    )
    step.encode(commands, cells, operator, before=before, source=source, after=after)
    commands.submit()
    return after.read().reshape(state.shape)


def constant_medium(state):
    shape = state.shape[:-1]
    return tuple(np.broadcast_to(v.reshape(3, 1, 1, 1), shape) for v in (SIGMA_S, SIGMA_T))


def random_medium(state, seed=3):
    """Six orders of magnitude, a part of it empty."""
    rng = np.random.default_rng(seed)
    sigma_t = 10.0 ** rng.uniform(-3, 1, state.shape[:-1])
    sigma_t[..., :2] = 0.0
    return rng.random(state.shape[:-1]) * sigma_t, sigma_t


def truth(state, medium, blocked=None):
    """(state, track) after one iteration: half-linear steps and what walls return."""
    s, t = medium
    after, _, track = lattice26.half_linear_step(state, s, t, CELL_M, blocked)
    if blocked is not None:
        white = np.round(WHITE * 255).reshape(3, 1, 1, 1) / 255.0
        back = lattice26_walls.bounced(state, s, t, CELL_M, blocked, white)
        after, track = after + back[0], track + back[1]
    return after, track


@pytest.mark.parametrize("has_rows", [False, True], ids=["cells", "rows"])
@pytest.mark.parametrize("has_walls", [False, True], ids=["open", "walls"])
@pytest.mark.parametrize("medium", ["homogeneous", "constant", "varied"])
def test_the_step_is_numpys(gpu, lattice, commands, walls, medium, has_walls, has_rows):
    if has_rows and not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    packs, visibility, _, _ = walls
    state = random_state()
    sigmas = random_medium(state) if medium == "varied" else constant_medium(state)
    wanted = truth(state, sigmas, 1.0 - visibility if has_walls else None)
    for operator, expected in zip((Operator.MOVE, Operator.TRACK), wanted, strict=True):
        got = stepped(
            gpu,
            lattice,
            commands,
            state,
            operator,
            packs if has_walls else None,
            None if medium == "homogeneous" else sigmas,
            has_rows,
        )
        # float32: some 50 terms, each of a few roundings.
        np.testing.assert_allclose(got, expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("has_rows", [False, True], ids=["cells", "rows"])
def test_eq_3_as_printed_takes_each_cells_own_medium(gpu, lattice, commands, has_rows):
    if has_rows and not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    state, share = random_state(), handed_on()
    s, t = (0.1 * sigma / CELL_M for sigma in random_medium(state))  # some hops are deep
    gain = np.moveaxis(paper_gain(s, t, CELL_M, share), 0, -1)
    wanted, _ = truth(gain * state, (np.zeros_like(s), np.zeros_like(t)))
    got = stepped(
        gpu, lattice, commands, state, Operator.MOVE, None, (s, t), has_rows, handed_on=share
    )
    # float32: some 50 terms, each of a few roundings.
    np.testing.assert_allclose(got, wanted, atol=1e-5 * np.abs(wanted).max())


@pytest.mark.parametrize("operator", [Operator.MOVE, Operator.TRACK])
def test_eq_3_in_cells_that_are_alike_is_that_of_one_medium(gpu, lattice, commands, operator):
    state, (s, t) = random_state(), ([0.2, 0.1, 0.0], [0.3, 0.1, 0.0])
    alike = tuple(np.broadcast_to(np.reshape(v, (3, 1, 1, 1)), state.shape[:-1]) for v in (s, t))
    rows = paper_rows(s, t, CELL_M)
    one = stepped(gpu, lattice, commands, state, operator, rows=rows)
    own = stepped(gpu, lattice, commands, state, operator, medium=alike, handed_on=handed_on())
    np.testing.assert_allclose(own, one, atol=1e-5 * np.abs(one).max())


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
