"""The device's 6-neighbour steps against the NumPy truth; energy; a floor beside a wall."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from airlight.gpu.memory import Buffer, buffer_of
from airlight.lattice.placement import Placement
from airlight.lpv.propagate import Propagate
from airlight.lpv.step import StepKind
from airlight.maths import lattice6, sh

COUNT = (6, 4, 10)  # x, y, z: unequal, more than one slab of eight layers
OFFSETS = lattice6.OFFSETS


def shape_of(count):
    return count[::-1]


@pytest.fixture
def propagated(gpu, commands, owned):
    """propagated(states (3, Z, Y, X, 4), iterations) -> the sum of the states after each step."""

    def solve(
        states,
        iterations,
        scheme="centroid",
        closed=None,
        reflected=None,
        *,
        storage="float32",
        has_tail=False,
    ):
        count = states.shape[3:0:-1]
        placement = Placement((0.0, 0.0, 0.0), 1.0, count)
        made = owned(
            Propagate(
                gpu,
                placement,
                StepKind(scheme, closed is not None, reflected is not None),
                storage,
            )
        )
        injected = owned(buffer_of(gpu, "injected", np.ascontiguousarray(states, np.float32)))
        if closed is None:
            faces = owned(Buffer(gpu, "faces", placement.cells * 32))
        else:
            packed = packed_faces(closed, np.zeros_like(closed) if reflected is None else reflected)
            faces = owned(buffer_of(gpu, "faces", packed))
        total = made.encode(commands, injected, faces, iterations, has_tail=has_tail)
        commands.submit()
        return total.read().reshape(states.shape).astype(np.float64)

    return solve


def packed_faces(closed, reflected):
    """(Z, Y, X, 8) u32 as lattice.blockers.Blockers.faces, of u8 shares (6, Z, Y, X)."""
    leaving = closed.astype(np.uint32) << 24
    for shift in (0, 8, 16):
        leaving |= reflected.astype(np.uint32) << shift
    arriving = [
        255 - lattice6.shifted(c[..., None].astype(np.float64), o)[..., 0]
        for c, o in zip(closed, OFFSETS, strict=True)
    ]
    octets = np.stack([*arriving, *[np.full_like(arriving[0], 255)] * 2], axis=-1)
    incoming = np.ascontiguousarray(octets.astype(np.uint8)).view(np.uint32)
    return np.concatenate([np.moveaxis(leaving, 0, -1), incoming], axis=-1)


def random_states(count=COUNT, seed=1):
    states = np.random.default_rng(seed).normal(size=(3, *shape_of(count), 4))
    states[..., 0] = np.abs(states[..., 0]) + 1.0
    return states


def power(states):
    return 4.0 * np.pi * states[..., 0].sum(axis=(1, 2, 3))


@pytest.mark.parametrize("scheme", ["centroid", "paper"])
@pytest.mark.parametrize("iterations", [1, 2, 7])
def test_open_space_is_the_numpy_truth(propagated, scheme, iterations):
    # the paper's scheme clamps negative intensities, as its equation does
    states = random_states()
    truth = lattice6.propagate(states, iterations, scheme, clamp_negative=scheme == "paper")
    expected = truth - states
    made = propagated(states, iterations, scheme)
    np.testing.assert_allclose(made, expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("count", [(2, 2, 2), (1, 3, 2), (5, 7, 9), (8, 6, 16), (10, 12, 3)])
def test_any_size_will_do(propagated, count):
    states = random_states(count)
    expected = lattice6.propagate(states, 3) - states
    made = propagated(states, 3)
    np.testing.assert_allclose(made, expected, atol=1e-5 * np.abs(expected).max())


def test_a_blocked_step_is_the_numpy_truth(propagated):
    # All power goes forward, so that nothing negative meets a closed face.
    states = random_states()
    states[..., 1:] *= 0.05
    closed = np.random.default_rng(2).integers(0, 256, size=(6, *shape_of(COUNT)))
    expected = lattice6.propagate_step(states, blocked=closed / 255.0)
    made = propagated(states, 1, closed=closed)
    np.testing.assert_allclose(made, expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("iterations", [8, 9, 16, 27, 40])
def test_doubling_is_the_same_as_adding_step_by_step(propagated, iterations):
    states = random_states()
    expected = lattice6.propagate(states, iterations) - states
    made = propagated(states, iterations)
    np.testing.assert_allclose(made, expected, atol=2e-5 * np.abs(expected).max())


def test_the_tail_is_what_endless_bounces_would_add(propagated):
    # One cell, closed and grey: every step keeps 3/5 of the light, for ever.
    states = np.zeros((3, 4, 4, 4, 4))
    states[:, 1, 2, 1, 0] = (1.0, 2.0, 3.0)
    closed = np.zeros((6, 4, 4, 4), np.int64)
    closed[:, 1, 2, 1] = 255
    total = propagated(states, 32, closed=closed, reflected=closed * 3 // 5, has_tail=True)
    np.testing.assert_allclose(power(total), 1.5 * power(states), rtol=1e-4)
    short = propagated(states, 24, closed=closed, reflected=closed * 3 // 5, has_tail=True)
    np.testing.assert_allclose(power(short), 1.5 * (1 - 0.6**24) * power(states), rtol=1e-4)


@pytest.mark.parametrize(
    ("storage", "iterations", "ceiling"),
    # Half floats .0004. Bytes .18 in this bare, streaming light; .04 to .08 in rooms.
    [("float16", 8, 5e-4), ("float16", 40, 5e-4), ("8bit", 8, 0.2), ("8bit", 40, 0.2)],
)
def test_smaller_storage_costs_accuracy(propagated, storage, iterations, ceiling):
    states = np.zeros((3, 12, 12, 12, 4))
    states[:, 2:10, 2:10, 0] = sh.cosine_lobe([1.0, 0.0, 0.0], 1.0)
    whole = propagated(states * 7e3, iterations)
    made = propagated(states * 7e3, iterations, storage=storage)
    error = np.linalg.norm(made - whole) / np.linalg.norm(whole)
    assert 0.0 < error <= ceiling


def test_smaller_storage_takes_less_memory(gpu, owned):
    def nbytes(storage):
        before = gpu.allocated_bytes
        owned(Propagate(gpu, Placement((0, 0, 0), 1.0, COUNT), StepKind(is_blocked=True), storage))
        return gpu.allocated_bytes - before

    whole, half, byte = (nbytes(storage) for storage in ("float32", "float16", "8bit"))
    lattice = 3 * 6 * 4 * 10 * 16
    assert (whole - half, whole - byte) == (3 * lattice // 2, 3 * lattice * 3 // 4)


def test_black_lattices_stay_black_in_any_storage(propagated):
    states = np.zeros((3, 4, 4, 4, 4))
    assert not propagated(states, 9, storage="float16").any()
    assert not propagated(states, 9, storage="8bit").any()


def test_no_iterations_bring_no_light(propagated):
    assert not propagated(random_states(), 0).any()


@pytest.mark.parametrize("scheme", ["centroid", "paper"])
def test_two_runs_are_the_same_to_the_bit(propagated, scheme):
    states = random_states()
    assert propagated(states, 5, scheme).tobytes() == propagated(states, 5, scheme).tobytes()


@pytest.mark.parametrize("normal", [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.48, -0.6, 0.64)])
def test_energy_is_kept(propagated, normal):
    # An isotropic and two cosine emitters; no light reaches the border in six steps.
    states = np.zeros((3, 14, 14, 14, 4))
    states[:, 7, 6, 7] = np.outer([1.0, 5.0, 0.1], sh.cosine_lobe(normal, 2.0))
    sums = [power(propagated(states, steps)) for steps in range(7)]
    for before, after in itertools.pairwise(sums):
        np.testing.assert_allclose(after - before, power(states), rtol=1e-5)


@pytest.mark.parametrize("is_white", [True, False])
def test_blockers_and_bounces_never_add_energy(propagated, is_white):
    rng = np.random.default_rng(3)
    states = random_states((8, 8, 8))
    states[..., 1:] *= 0.1
    closed = rng.integers(0, 256, size=(6, 8, 8, 8)) * (rng.random((6, 8, 8, 8)) < 0.5)
    reflected = closed if is_white else closed // 2
    sums = [power(propagated(states, n, closed=closed, reflected=reflected)) for n in range(9)]
    gains = np.diff(sums, axis=0)
    assert (gains <= power(states) * (1 + 1e-5)).all()
    assert (np.diff(gains, axis=0) <= 1e-5 * power(states)).all()


def test_a_closed_white_cell_keeps_its_light(propagated):
    # a furnace of one cell: all six faces closed from inside, and white
    states = np.zeros((3, 4, 4, 4, 4))
    states[:, 1, 2, 1, 0] = (1.0, 2.0, 3.0)
    closed = np.zeros((6, 4, 4, 4), np.int64)
    closed[:, 1, 2, 1] = 255
    total = propagated(states, 10, closed=closed, reflected=closed)
    np.testing.assert_allclose(power(total), 10.0 * power(states), rtol=1e-5)
    inside = total[:, 1, 2, 1, 0].sum()
    assert total[..., 0].sum() == pytest.approx(inside, rel=1e-12)


def test_a_closed_wall_keeps_light_on_its_side(propagated):
    states = np.zeros((3, 6, 6, 6, 4))
    states[:, 3, 3, 1] = sh.cosine_lobe([1.0, 0.0, 0.0], 1.0)
    closed = np.zeros((6, 6, 6, 6), np.int64)
    closed[0, :, :, 2] = closed[1, :, :, 3] = 255
    for reflected in (None, closed):
        total = propagated(states, 8, closed=closed, reflected=reflected)
        assert not total[:, :, :, 3:].any()
        assert total[:, :, :, :3].any()


@pytest.mark.parametrize("scheme", ["centroid", "paper"])
def test_axes_are_alike(propagated, scheme):
    states = random_states((6, 4, 8))
    swapped = states.transpose(0, 3, 2, 1, 4)[..., [0, 3, 2, 1]]
    direct = propagated(states, 4, scheme).transpose(0, 3, 2, 1, 4)[..., [0, 3, 2, 1]]
    made = propagated(swapped, 4, scheme)
    np.testing.assert_allclose(made, direct, atol=1e-5 * np.abs(direct).max())


def test_channels_do_not_mix(propagated):
    states = random_states()
    states[1] = 0.0
    total = propagated(states, 3)
    assert total[0].any()
    assert not total[1].any()


def floor_by_quadrature():
    """Irradiance (z, x) at 12 x 12 floor points under a wall of exitance 1, by midpoints."""
    fine = (np.arange(240) + 0.5) / 20.0
    y, zw = np.meshgrid(fine, fine, indexing="ij")
    centres = np.arange(12) + 0.5
    rows = []
    for z in centres:
        r2 = centres[:, None, None] ** 2 + y**2 + (zw - z) ** 2
        rows.append((centres[:, None, None] * y / (np.pi * r2 * r2)).sum(axis=(1, 2)) / 400.0)
    return np.array(rows)


@pytest.mark.parametrize(("scheme", "ceiling"), [("centroid", 0.08), ("paper", 1.2)])
def test_a_floor_beside_a_wall(propagated, scheme, ceiling):
    # Wall and floor are two sides of an open lattice, x = 0 and y = 0; 32 iterations.
    states = np.zeros((3, 24, 24, 24, 4))
    states[:, 6:18, :12, 0] = sh.cosine_lobe([1.0, 0.0, 0.0], 1.0)
    total = (states + propagated(states, 32, scheme))[0, 6:18, 0, :12]
    up = [0.0, 1.0, 0.0]
    if scheme == "paper":
        floor = lattice6.paper_surface_irradiance(total, up, 1.0)
    else:
        floor = lattice6.surface_irradiance(total, up, 1.0)
    truth = floor_by_quadrature()
    assert np.linalg.norm(floor - truth) / np.linalg.norm(truth) <= ceiling


def test_hops_keep_what_they_are_told_of_the_spread(gpu, commands, owned):
    states = np.zeros((3, 5, 6, 7, 4))
    states[:, 2, 3, 3] = (1.0, 0.3, -0.7, 1.1)
    placement = Placement((0.0, 0.0, 0.0), 1.0, (7, 6, 5))
    made = owned(Propagate(gpu, placement, StepKind(kept=0.6)))
    injected = owned(buffer_of(gpu, "injected", states.astype(np.float32)))
    total = made.encode(commands, injected, owned(Buffer(gpu, "faces", placement.cells * 32)), 1)
    commands.submit()
    seen = total.read().reshape(states.shape)
    for hop in lattice6.hops("centroid", 0.6):
        x, y, z = hop.offset
        wanted = hop.matrix @ states[0, 2, 3, 3]
        np.testing.assert_allclose(seen[0, 2 + z, 3 + y, 3 + x], wanted, rtol=1e-5, atol=1e-7)


def test_memory_is_given_back(gpu):
    before = gpu.allocated_bytes
    scope = gpu.scope()
    made = Propagate(scope, Placement((0, 0, 0), 1.0, COUNT), StepKind(is_blocked=True))
    assert gpu.allocated_bytes > before
    scope.release()
    assert gpu.allocated_bytes == before
    del made  # it was there all the time
