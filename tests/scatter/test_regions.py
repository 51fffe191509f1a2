"""Corrections by regions on the device: beside NumPy, and beside the steps they stand for."""

import numpy as np
import pytest

from airlight.gpu.memory import Buffer
from airlight.maths import regions as maths
from airlight.scatter.propagate import Operator
from airlight.scatter.schedule import region_steps_to, schedule
from airlight.scatter.state_sum import LatticeKind, StateSum

from .test_propagate import packed_faces  # type: ignore[import-not-found]

COUNT = (10, 6, 9)  # rows of lanes, and an odd side
SHAPE = COUNT[::-1]
CELLS = int(np.prod(COUNT))
SIGMA_T = np.array([0.1, 0.6, 2.5])
ALBEDO = np.array([1.0, 0.9, 0.5])


def walls():
    """Open shares (6, Z, Y, X): two walls across z with gaps at either end, and furniture."""
    rng = np.random.default_rng(2)
    faces = np.ones((6, *SHAPE))
    faces[:, rng.random(SHAPE) < 0.1] = 0.6
    for z, gap in ((3, np.s_[:2]), (6, np.s_[-2:])):
        shut = np.ones(COUNT[0], bool)
        shut[gap] = False
        faces[4, z][:, shut] = faces[5, z - 1][:, shut] = 0.0
    # Nothing leaves the box.
    for hop, border in ((0, np.s_[..., 0]), (2, np.s_[:, 0, :]), (4, np.s_[0])):
        faces[hop][border] = 0.0
    return np.round(faces * 255) / 255


def prepared(gpu, commands, lattice, *, is_varied, iterations=6):
    """A lattice with walls and media that has been solved once, so that its regions are known."""
    plan = schedule("regions", iterations)
    states = StateSum(gpu, COUNT, 1.0, plan, LatticeKind(has_walls=True, is_varied=is_varied))
    if is_varied:
        rng = np.random.default_rng(5)
        sigma_t = SIGMA_T.reshape(3, 1, 1, 1) * rng.random((3, *SHAPE))
        sigma_s = sigma_t * ALBEDO.reshape(3, 1, 1, 1)
        states.set_varied(lattice(np.stack([sigma_s, sigma_t], axis=-1)))
    else:
        states.set_homogeneous(ALBEDO * SIGMA_T, SIGMA_T)
    white = np.full((*SHAPE, 4), 200, np.uint8)
    states.set_walls(commands, lattice(packed_faces(walls())), lattice(white.view(np.uint32)))
    return states


def stepped(gpu, commands, states, power):
    """M of powers (3, Z, Y, X) without direction, power alone."""
    state = np.zeros((*power.shape, 4), np.float32)
    state[..., 0] = power
    before, after = (Buffer(gpu, name, state.nbytes) for name in ("before", "after"))
    before.write(state)
    states._step.encode(
        commands, states.medium, Operator.MOVE, before=before, source=states._zero, after=after
    )
    commands.submit()
    return after.read().reshape(state.shape)[..., 0].astype(np.float64)


@pytest.mark.parametrize("is_varied", [False, True])
def test_regions_and_their_exchange_are_numpys(gpu, commands, lattice, is_varied):
    states = prepared(gpu, commands, lattice, is_varied=is_varied)
    states.encode(commands, lattice(np.ones((3, *SHAPE, 4))))
    commands.submit()
    regions = states._regions.regions.read(np.uint32).reshape(SHAPE) & 255
    want = maths.flooded(COUNT, walls())
    np.testing.assert_array_equal(np.where(regions == 255, -1, regions), want)
    # The matrix holds what steps do to light that is alike in each region.
    got = states._regions.matrix.read().reshape(3, maths.REGIONS, maths.REGIONS)
    for channel in range(3):

        def step(power, channel=channel):
            return stepped(gpu, commands, states, np.broadcast_to(power, (3, *SHAPE)))[channel]

        gained = maths.gain(maths.exchange(want, step), want)
        # Open shares are bytes, sums in units of 2e-9; the inverse makes much of what is closed.
        np.testing.assert_allclose(got[channel], gained, atol=2e-3 * np.abs(gained).max())


def test_a_correction_is_numpys(gpu, commands, lattice):
    states = prepared(gpu, commands, lattice, is_varied=False)
    source = np.random.default_rng(1).random((3, *SHAPE, 4))
    states.encode(commands, lattice(source))
    commands.submit()
    regions = maths.flooded(COUNT, walls())
    gained = states._regions.matrix.read().reshape(3, maths.REGIONS, maths.REGIONS)
    before, after = lattice(source), lattice(1.5 * source)
    states._regions.correct(commands, current=before, stepped=after)
    commands.submit()
    got = after.read().reshape(source.shape)
    for channel in range(3):
        power = source[channel, ..., 0]
        want = maths.corrected(power, 1.5 * power, regions, gained[channel])
        np.testing.assert_allclose(got[channel, ..., 0], want, rtol=1e-4, atol=1e-4 * want.max())
    np.testing.assert_allclose(got[..., 1:], 1.5 * source[..., 1:], rtol=1e-6)


@pytest.mark.parametrize("is_varied", [False, True])
def test_light_comes_around_walls(gpu, commands, lattice, is_varied):
    """Behind two walls: 24 steps with regions beside as many without them, of the light of 2000."""
    source = np.zeros((3, *SHAPE, 4))
    source[:, 1, 3, 8, 0] = 1.0
    behind = {}
    for name, acceleration, count in (
        ("all", "none", 2000),
        ("plain", "none", 24),
        ("regions", "regions", 24),
    ):
        states = prepared(gpu, commands, lattice, is_varied=is_varied, iterations=24)
        states.schedule = schedule(acceleration, count)
        total, _ = states.encode(commands, lattice(source))
        commands.submit()
        behind[name] = total.read().reshape(source.shape)[:, 7:, ..., 0].sum(axis=(1, 2, 3))
    print(behind)
    assert np.all(behind["plain"][:2] < 0.7 * behind["all"][:2])
    np.testing.assert_allclose(behind["regions"][:2], behind["all"][:2], rtol=0.05)


def test_iterations_that_leave_a_residual():
    assert region_steps_to(0.1) < region_steps_to(0.01) < 48
