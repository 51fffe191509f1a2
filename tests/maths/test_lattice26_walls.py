"""Visibility of 26 hops by face paths, and what walls give back."""

import numpy as np
import pytest

from airlight.maths import lattice26, lattice26_walls

SHAPE = (4, 5, 6)


def faces_with_wall(x: int) -> np.ndarray:
    """A closed wall across x, on the low faces of the cells there, both ways."""
    faces = np.ones((6, *SHAPE))
    faces[0, :, :, x] = 0.0
    faces[1, :, :, x - 1] = 0.0
    return faces


def test_a_closed_wall_stops_every_hop_through_it_and_no_other():
    visibility = lattice26_walls.open_hops(faces_with_wall(3))
    offsets = lattice26.hops().offsets
    for j, (dx, _, _) in enumerate(offsets.tolist()):
        expected = np.ones(SHAPE)
        if dx > 0:
            expected[:, :, 2] = 0.0
        if dx < 0:
            expected[:, :, 3] = 0.0
        # Hops that leave the lattice may pass beside the wall.
        np.testing.assert_array_equal(visibility[j][1:-1, 1:-1], expected[1:-1, 1:-1])


def test_an_edge_hop_takes_the_mean_of_its_two_paths():
    faces = np.ones((6, *SHAPE))
    faces[0, 1, 1, 3] = 0.25  # into (x, y, z) = (3, 1, 1) along +x
    faces[2, 1, 2, 3] = 0.5  # into (3, 2, 1) along +y
    j = lattice26.hops().offsets.tolist().index([1, 1, 0])
    # From (2, 1, 1): x then y passes both, y then x neither.
    assert lattice26_walls.open_hops(faces)[j, 1, 1, 2] == pytest.approx(0.5 * (0.25 * 0.5 + 1.0))


def test_returned_light_sends_no_net_power_into_a_flat_wall():
    k = lattice26_walls.returned_sharpness()
    assert k == pytest.approx(1.526, abs=5e-4)
    state = np.array([1.0, 0.0, 0.0, k]).reshape(1, 1, 1, 1, 4)
    into = [j for j, d in enumerate(lattice26.hops().directions) if d[2] < 0]
    assert sum(lattice26.leaving_power(state, j)[0, 0, 0, 0] for j in into) == pytest.approx(0.0)


def test_no_hop_takes_less_than_nothing_of_a_free_lobe():
    state = np.array([1.0, 0.0, 0.0, lattice26_walls.free_sharpness()]).reshape(1, 1, 1, 1, 4)
    powers = [lattice26.leaving_power(state, j)[0, 0, 0, 0] for j in range(26)]
    assert min(powers) == pytest.approx(0.0, abs=1e-12)
    assert sum(powers) == pytest.approx(1.0)


@pytest.mark.parametrize("sigma_t", [0.0, 0.4, 6.0])
def test_a_white_wall_in_white_air_keeps_all_power(sigma_t: float):
    state = np.random.default_rng(2).normal(size=(1, *SHAPE, 4))
    blocked = np.random.default_rng(3).random((26, *SHAPE))
    blocked[:, [0, -1]] = blocked[:, :, [0, -1]] = blocked[:, :, :, [0, -1]] = 1.0
    grid = np.full((1, *SHAPE), sigma_t)
    after, _, _ = lattice26.half_linear_step(state, grid, grid, 1.0, blocked)
    back, track = lattice26_walls.bounced(state, grid, grid, 1.0, blocked, 1.0)
    assert (after + back)[..., 0].sum() == pytest.approx(state[..., 0].sum(), rel=1e-12)
    assert np.isfinite(track).all()


def test_a_wall_shares_its_normal_by_which_faces_are_closed():
    blocked = np.zeros((26, 1, 1, 1))
    offsets = lattice26.hops().offsets.tolist()
    j = offsets.index([1, 1, 0])
    even = lattice26_walls.wall_normals(blocked, j)[0, 0, 0]
    np.testing.assert_allclose(even, [-0.5, -0.5, 0.0])
    blocked[offsets.index([1, 0, 0])] = 1.0
    np.testing.assert_allclose(
        lattice26_walls.wall_normals(blocked, j)[0, 0, 0], [-1, 0, 0], atol=2e-3
    )


def test_an_absorbing_wall_does_not_profit_from_negative_power():
    state = np.array([1.0, 2.79, 0.0, 0.0]).reshape(1, 1, 1, 1, 4)
    blocked = np.ones((26, 1, 1, 1))
    nothing = np.zeros((1, 1, 1, 1))
    kept, _ = lattice26_walls.bounced(state, nothing, nothing, 1.0, blocked, 0.0)
    assert kept[..., 0].sum() < 0.0


def test_what_walls_cover_counts_by_what_lies_before_others(wgsl):
    """A wall that ends at another one covers half of two corners: its face is closed whole."""
    np.testing.assert_allclose(
        lattice26_walls.share_between([[1.0, 1.0, 0.5, 0.5]], [[[1.0, 1.0, 0.5, 0.5]] * 2]), 1.0
    )
    rng = np.random.default_rng(3)
    values = rng.random((500, 4)).astype(np.float32)
    most = (rng.random((500, 2, 4)) * (rng.random((500, 2, 1)) > 0.1)).astype(np.float32)
    got = wgsl("share_between", "share_between", values, most)
    np.testing.assert_allclose(got, lattice26_walls.share_between(values, most), rtol=1e-5)
