"""The 26-neighbour table's digits; conservation, stability and agreement of the two steps."""

import numpy as np
import pytest

from airlight.maths import lattice26

# One face, one edge, one corner.
KINDS = [0, 6, 18]


def test_digits_of_the_notes() -> None:
    h = lattice26.hops()
    np.testing.assert_allclose(
        h.solid_angles[KINDS], [0.575261946823, 0.464712275442, 0.442281453514], atol=1e-12
    )
    np.testing.assert_allclose(
        h.weights[KINDS], [0.053879673181, 0.035161059130, 0.031848656420], atol=1e-12
    )
    np.testing.assert_allclose(
        h.gain0[KINDS], [0.232119954294, 0.187512823907, 0.178461918682], atol=1e-12
    )
    np.testing.assert_allclose(
        h.gain1[KINDS], [0.373900505487, 0.302047016413, 0.287467752647], atol=1e-12
    )
    assert lattice26.mean_hop_length() == pytest.approx(1.3612889279, abs=1e-10)


def test_table_is_complete() -> None:
    h = lattice26.hops()
    assert len({tuple(o) for o in h.offsets.tolist()}) == 26
    assert h.solid_angles.sum() == pytest.approx(4.0 * np.pi, rel=1e-13)
    assert h.weights.sum() == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_allclose(h.weights @ h.directions, 0.0, atol=1e-15)
    moment = np.einsum("j,ja,jb->ab", h.weights, h.directions, h.directions)
    np.testing.assert_allclose(moment, np.eye(3) / 3.0, atol=1e-15)


def lump(size: int = 13) -> np.ndarray:
    """One cell of random power and direction for three channels, mid-lattice."""
    state = np.zeros((3, size, size + 1, size + 2, 4))
    state[:, size // 2, size // 2, size // 2] = np.random.default_rng(3).normal(size=(3, 4))
    state[..., 0] = np.abs(state[..., 0])
    return state


@pytest.mark.parametrize("sigma", [0.0, 0.1, 3.0, 50.0])
def test_power_is_kept_at_albedo_one(sigma: float) -> None:
    state = lump()
    power = state[..., 0].sum(axis=(1, 2, 3))
    for _ in range(5):
        state, scattered = lattice26.deposit_step(state, [sigma] * 3, [1.0] * 3, 1.0)
        np.testing.assert_allclose(state[..., 0].sum(axis=(1, 2, 3)), power, rtol=1e-12)
    assert np.isfinite(scattered).all()


def test_clear_air_keeps_direction_by_rho_squared() -> None:
    state = lump()
    flux = state[..., 1:].sum(axis=(1, 2, 3))
    after, scattered = lattice26.deposit_step(state, [0.0] * 3, [1.0] * 3, 1.0)
    assert not scattered.any()
    np.testing.assert_allclose(after[..., 1:].sum(axis=(1, 2, 3)), lattice26.RHO**2 * flux)


def test_finer_cells_of_clear_air_turn_less_light_on_a_hop() -> None:
    # As much as ever on up to 25 cells; then the loss per hop falls by less than cells shrink.
    lost = [1.0 - lattice26.persistence(n, is_clear=True) for n in (16, 25, 50, 100)]
    assert lost[0] == lost[1] == pytest.approx(1.0 - lattice26.RHO**2)
    assert lost[1] / lost[2] == pytest.approx(lost[2] / lost[3])
    assert 1.5 < lost[1] / lost[2] < 2.0


def test_absorption_takes_what_the_depth_says() -> None:
    h = lattice26.hops()
    state = lump()
    state[..., 1:] = 0.0
    power = state[..., 0].sum(axis=(1, 2, 3))
    sigma = np.array([0.1, 0.7, 2.0])
    after, _ = lattice26.deposit_step(state, sigma, [0.0] * 3, 0.5)
    kept = [h.weights @ np.exp(-s * 0.5 * h.lengths) for s in sigma]
    np.testing.assert_allclose(after[..., 0].sum(axis=(1, 2, 3)), power * kept)


def test_thick_air_does_not_explode() -> None:
    state = lump()
    first = np.abs(state).sum()
    for _ in range(40):
        state, _ = lattice26.deposit_step(state, [5.0] * 3, [0.99] * 3, 1.0)
    assert np.abs(state).sum() < first


def test_half_linear_equals_the_homogeneous_step() -> None:
    state = lump(5)  # small: the borders take part
    sigma_t, albedo = np.array([0.05, 0.8, 4.0]), np.array([1.0, 0.9, 0.5])
    grids = [np.broadcast_to(v.reshape(3, 1, 1, 1), state.shape[:-1]) for v in (albedo, sigma_t)]
    sigma_s = grids[0] * grids[1]
    a, b, power = state, state, state[..., 0].sum(axis=(1, 2, 3))
    for _ in range(4):
        a, scattered_a = lattice26.deposit_step(a, sigma_t, albedo, 0.7)
        b, scattered_b, track = lattice26.half_linear_step(b, sigma_s, grids[1], 0.7)
        np.testing.assert_allclose(b, a, atol=1e-12 * power.max())
        np.testing.assert_allclose(scattered_b, scattered_a, atol=1e-12 * power.max())
        # what scatters is sigma_s times the track
        np.testing.assert_allclose(sigma_s * track[..., 0], scattered_b, atol=1e-12 * power.max())


def test_half_linear_balances_in_a_heterogeneous_medium() -> None:
    state = lump()
    sigma_t = np.random.default_rng(5).random(state.shape[:-1]) * 3.0
    sigma_t[..., :5] = 0.0
    for _ in range(4):
        before = state[..., 0].sum(axis=(1, 2, 3))
        state, _, track = lattice26.half_linear_step(state, sigma_t, sigma_t, 1.0)
        np.testing.assert_allclose(state[..., 0].sum(axis=(1, 2, 3)), before, rtol=1e-12)
        assert np.isfinite(track).all()


def test_track_in_a_vacuum_is_the_hop_length() -> None:
    h, state = lattice26.hops(), lump()
    state[..., 1:] = 0.0
    nothing = np.zeros(state.shape[:-1])
    _, _, track = lattice26.half_linear_step(state, nothing, nothing, 0.25)
    expected = state[..., 0].sum() * 0.25 * (h.weights @ h.lengths)
    assert track[..., 0].sum() == pytest.approx(expected, rel=1e-12)
    np.testing.assert_allclose(track[..., 1:].sum(axis=(0, 1, 2, 3)), 0.0, atol=1e-12)


def test_blocked_hops_hand_on_nothing() -> None:
    state = lump()
    blocked = np.ones((26, *state.shape[1:-1]))
    after, _ = lattice26.deposit_step(state, [0.0] * 3, [1.0] * 3, 1.0, blocked)
    assert not after.any()
    one = np.zeros(state.shape[:-1])
    after, _, track = lattice26.half_linear_step(state, one, one, 1.0, blocked)
    assert not after.any()
    assert not track.any()


def test_steps_commute_with_swapping_axes() -> None:
    rng = np.random.default_rng(6)
    state, sigma = rng.normal(size=(1, 4, 5, 6, 4)), rng.random((1, 4, 5, 6))
    direct = lattice26.half_linear_step(state, 0.5 * sigma, sigma, 1.0)
    swapped = lattice26.half_linear_step(
        state.transpose(0, 3, 2, 1, 4)[..., [0, 3, 2, 1]],
        0.5 * sigma.transpose(0, 3, 2, 1),
        sigma.transpose(0, 3, 2, 1),
        1.0,
    )
    for k in (0, 2):
        back = swapped[k].transpose(0, 3, 2, 1, 4)[..., [0, 3, 2, 1]]
        np.testing.assert_allclose(back, direct[k], atol=1e-12)
    np.testing.assert_allclose(swapped[1].transpose(0, 3, 2, 1), direct[1], atol=1e-12)


def transport_root(albedo: float) -> float:
    """k of light that falls as exp(-k depth) far from its source: albedo artanh(k) = k."""
    low, high = 1e-9, 1.0 - 1e-14
    for _ in range(200):
        middle = 0.5 * (low + high)
        is_below = albedo * np.arctanh(middle) < middle
        low, high = (middle, high) if is_below else (low, middle)
    return middle


def test_flux_is_damped_as_transport_theory_has_it() -> None:
    assert lattice26.flux_extinction(0.0) == pytest.approx(1.0 / 3.0)
    assert lattice26.flux_extinction(1.0) == pytest.approx(1.0)
    for albedo in np.linspace(0.02, 0.98, 25):
        share = transport_root(albedo) ** 2 / (3.0 * (1.0 - albedo))
        # The fit's own error.
        assert lattice26.flux_extinction(albedo) == pytest.approx(share, abs=0.002)


def test_flux_never_outgrows_power() -> None:
    for kept in (lattice26.RHO**2, 1.0):
        gain = lattice26.flux_gain([0.0, 0.5, 0.9, 1.0], 80.0, 0.5, kept)
        assert (gain >= 1.0).all()
        assert (kept * gain**2 <= 1.0 + 1e-12).all()
    assert lattice26.flux_gain(0.0, 0.0, 1.0) == 1.0


def _falls(albedo: float, depth: float) -> float:
    """Light of a glowing plane in a medium: how fast it falls per mean free path, 2 to 5 of them.

    Columns of 3 x 3 cells stand for planes without an end: all are as the middle one.
    """
    count = int(14 / depth) | 1
    state = np.zeros((1, count, 3, 3, 4))
    state[:, count // 2, :, :, 0] = 1.0
    total = np.zeros(count)
    for _ in range(int(16 / depth)):
        state, scattered = lattice26.deposit_step(state, [depth], [albedo], 1.0)
        state[:] = state[:, :, 1:2, 1:2]
        total += scattered[0, :, 1, 1]
    near, far = (count // 2 + int(m / depth) for m in (2, 5))
    return float(np.log(total[near] / total[far]) / ((far - near) * depth))


@pytest.mark.parametrize("albedo", [0.3, 0.6])
def test_light_in_absorbing_air_falls_less_than_two_bands_say(albedo, monkeypatch) -> None:
    depth, truth = 0.4, transport_root(albedo)
    corrected = _falls(albedo, depth)
    monkeypatch.setattr(lattice26, "flux_gain", lambda *_: np.ones(()))
    plain = _falls(albedo, depth)
    # What hops themselves turn aside stays: measured .38 of .55, and .16 of .29 (albedo .3, .6).
    assert 0.0 < corrected - truth < 0.8 * (plain - truth)


def test_scattered_light_brings_to_a_wall_what_its_hops_bring():
    """Evenly spread isotropic power: nine hops of each cell go into a wall, E = scale A/4."""
    power = np.zeros((1, 4, 4, 4, 4))
    power[..., 0] = 1.0
    down = [j for j in range(26) if lattice26.hops().offsets[j, 2] < 0]
    into = sum(lattice26.leaving_power(power, j)[0, 0, 0, 0] for j in down)
    assert lattice26.scattered_lookup_scale() / 4.0 == pytest.approx(into, rel=1e-12)
