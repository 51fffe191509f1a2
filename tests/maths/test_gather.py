"""Rays of a gather and their weights against integrals; WGSL against NumPy."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from airlight.maths import gather, gather_turning, sampling
from airlight.maths.sampling import fibonacci_sphere

RNG = np.random.default_rng(17)
UP = np.array([0.0, 0.0, 1.0])


def test_rays_of_a_point_and_of_its_neighbours_are_even():
    """The mean of x y over n points of the square is 1/4; random ones are off by 0.22 / sqrt(n)."""
    along = gather.ray_numbers(7, 11, np.arange(256))
    assert np.prod(along, axis=-1).mean() == pytest.approx(0.25, abs=0.22 / 16 / 3)
    later = gather.later_numbers(7, 11, np.arange(256), 1)
    assert np.prod(later, axis=-1).mean() == pytest.approx(0.25, abs=0.22 / 16 / 2)
    y, x = np.mgrid[100:116, 40:56]
    beside = gather.ray_numbers(x, y, 3).reshape(-1, 2)
    assert np.prod(beside, axis=-1).mean() == pytest.approx(0.25, abs=0.22 / 16 / 2)


def test_no_segment_of_a_path_follows_from_another():
    """Correlations of the waves of all numbers of 4096 paths of four segments.

    Those of random numbers are 1/64 and, of 120 pairs, the furthest a few times as far off; numbers
    that are others' but for a constant have some near 1.
    """
    k = np.arange(4096)
    later = [gather.later_numbers(7, 11, k, segment) for segment in (1, 2, 3)]
    turns = 2.0 * np.pi * np.concatenate([gather.ray_numbers(7, 11, k), *later], axis=-1)
    waves = np.concatenate([np.cos(turns), np.sin(turns)], axis=-1)
    assert np.abs(np.corrcoef(waves.T) - np.eye(16)).max() < 5.0 / 64


def test_the_numbers_of_two_segments_fill_the_space_of_both():
    """No wave of few turns over the numbers of two segments stands out of 1024 paths.

    Random numbers would leave waves of 1/32. Numbers of which small multiples add up to nearly a
    whole number leave some wave near 1: what paths find is then the mean over a few planes.
    """
    k = np.arange(1024)
    numbers = [gather.ray_numbers(7, 11, k), gather.later_numbers(7, 11, k, 1)]
    turns = np.array(list(itertools.product(range(-4, 5), repeat=4)))
    turns = turns[turns.any(axis=-1) & (np.abs(turns).prod(axis=-1, where=turns != 0) <= 4)]
    waves = np.exp(2j * np.pi * np.concatenate(numbers, axis=-1) @ turns.T).mean(axis=0)
    assert np.abs(waves).max() < 0.3


def test_directions_are_distributed_as_their_cosine():
    """Means over cosine-distributed directions: of the cosine 2/3, of its square 1/2."""
    n = fibonacci_sphere(50)
    u = gather.ray_numbers(np.arange(50)[:, None], 0, np.arange(2048))
    d = gather.cosine_direction(np.broadcast_to(n[:, None], (*u.shape[:2], 3)), u)
    np.testing.assert_allclose(np.linalg.norm(d, axis=-1), 1.0)
    cosine = (d * n[:, None]).sum(axis=-1)
    np.testing.assert_allclose(cosine.mean(axis=1), 2.0 / 3.0, atol=2e-3)
    np.testing.assert_allclose((cosine**2).mean(axis=1), 0.5, atol=2e-3)


def test_lattices_are_put_right_where_paths_tell_by_how_much():
    """A lattice `off` times too bright, where half of what its light comes from is traced."""
    for off in (0.6, 0.8, 1.0, 1.25, 1.6):
        factor = gather.calibration(0.5, off, off * 0.5)
        # The doubt leaves k^2 / (1 + k^2) of what the lattice is off.
        assert factor == pytest.approx(1.0 / off, rel=0.1)
        assert abs(np.log(factor * off)) <= 0.2 * abs(np.log(off)) + 1e-12
    # Where nearly all light comes from lattices, a small difference says little.
    assert gather.calibration(0.2, 5.04, 4.6) == pytest.approx(1.0, abs=0.06)
    # Nothing known, nothing to scale; and no factor without a bound.
    assert gather.calibration(1.0, 0.0, 0.0) == 1.0
    assert gather.calibration(100.0, 1.0, 0.1) == gather.MOST_CALIBRATION


def test_a_point_is_like_itself_and_unlike_what_faces_elsewhere_or_lies_off_its_plane():
    p = np.zeros(3)
    assert gather.likeness(p, UP, p, UP, 0.1) == 1.0
    assert gather.likeness(p, UP, (5.0, 0.0, 0.0), UP, 0.1) == 1.0
    assert gather.likeness(p, UP, p, (0.0, 1.0, 0.0), 0.1) == 0.0
    assert gather.likeness(p, UP, (0.0, 0.0, 0.00025), UP, 0.1) == pytest.approx(np.exp(-1.0))
    # On a ball, neighbours lie off the plane by what their normals say.
    turn = np.array([np.sin(0.2), 0.0, np.cos(0.2)])
    assert gather.likeness(UP, UP, turn, turn, 0.01) == pytest.approx(np.cos(0.2) ** 8)


def test_points_share_along_a_wall_and_little_towards_it():
    """Beside a wall that faces +X, .1 m away, with media and without."""
    near = gather.nearness((1.0, 0.0, 0.0), 10.0, 0.0)
    assert gather.closeness((0.0, 0.0, 0.0), *near) == 1.0
    assert gather.closeness((0.3, 0.2, 0.1), *gather.nearness(UP, 0.0, 0.0)) == 1.0
    towards, along = (gather.closeness(offset, *near) for offset in ((0.01, 0, 0), (0, 0.04, 0)))
    assert towards == pytest.approx(along) == pytest.approx(np.exp(-1.0))
    # Media light a point from everywhere: the same in all directions.
    hazy = gather.nearness((1.0, 0.0, 0.0), 10.0, 1.0)
    assert gather.closeness((0, 0.01, 0), *hazy) == pytest.approx(np.exp(-1.0))
    # A wall aslant is the same one, turned.
    turn = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    offset = np.array([0.004, 0.03, -0.02])
    turned = gather.nearness(turn @ (1.0, 0.0, 0.0), 10.0, 0.0)
    assert gather.closeness(turn @ offset, *turned) == pytest.approx(
        gather.closeness(offset, *near)
    )


def test_flux_of_rays_is_the_irradiance_of_turned_normals():
    """Light from a cone that all normals see: E(n) is the product with n, for any n."""
    axis = np.array([0.6, 0.0, 0.8])
    d = gather.cosine_direction(np.tile(UP, (200_000, 1)), RNG.random((200_000, 2)))
    radiance = np.where(d @ axis > 0.95, 3.0, 0.0)
    flux = np.pi * (radiance[:, None] * gather_turning.flux_along(UP, d)).mean(axis=0)
    solid_angle = 2.0 * np.pi * 0.05
    # The mean of directions in a cone is along its axis, (1 + cos) / 2 long.
    np.testing.assert_allclose(flux, 3.0 * solid_angle * 0.975 * axis, atol=0.015)
    np.testing.assert_allclose(gather_turning.flux_along(UP, d) @ UP, 1.0)


def test_what_differs_by_its_noise_is_the_same():
    """Sums of 16 numbers each: of one source, and of one of twice the light."""
    rays = RNG.exponential(size=(2, 4000, 16))
    sums = rays.sum(axis=-1)
    spread = gather.variance_of_sum(sums, (rays**2).sum(axis=-1), 16)
    assert spread.mean() == pytest.approx(15.0, rel=0.05)  # n variances, less that of their mean
    assert gather.sameness(*sums, spread.sum(axis=0)).mean() > 0.85
    twice = gather.sameness(sums[0], 2.0 * sums[1], spread[0] + 4.0 * spread[1])
    assert twice.mean() < gather.sameness(*sums, spread.sum(axis=0)).mean() - 0.1
    assert gather.sameness(1.0, 2.0, 0.0) < 1e-6
    assert gather.sameness(0.0, 0.0, 0.0) == 1.0


def test_light_of_points_turned_to_another_normal():
    """Even light over their horizon in full, beams the more the lower they are."""
    up = np.array([0.0, 0.0, 1.0])
    angles = np.radians([0.0, 20.0, 45.0, 70.0, 90.0])
    normals = np.stack([np.sin(angles), np.zeros(5), np.cos(angles)], axis=-1)
    even = (1.0 + np.cos(angles)) / 2.0
    np.testing.assert_allclose(gather_turning.turn_ratio(up, normals), even, rtol=1e-12)
    # A beam of a cosine to the points' normal, turned towards it and away from it by 20 degrees.
    for degrees, off in ((80.0, 0.02), (60.0, 0.15), (30.0, 0.5)):
        beam = np.array([np.tan(np.radians(degrees)), 0.0, 1.0])
        for side in (-1.0, 1.0):
            n = np.array([side * np.sin(np.radians(20.0)), 0.0, np.cos(np.radians(20.0))])
            true = max(float(beam @ n), 0.0)
            assert gather_turning.turn_ratio(beam, n) - 1.0 == pytest.approx(true - 1.0, rel=off)
    # Of light without a direction nothing follows.
    assert gather_turning.turn_ratio(np.zeros(3), up) == 1.0


def test_detail_follows_a_smooth_field_where_that_has_light():
    assert gather_turning.detailed(2.0, 3.0, 3.0) == 2.0
    assert gather_turning.detailed(1.0, 10.0, 20.0) == pytest.approx(2.0, rel=0.01)
    assert gather_turning.detailed(1.0, 0.0, 0.01) == pytest.approx(1.1)
    assert gather_turning.detailed(1.0, 1.0, 0.0) == 0.25
    assert gather_turning.detailed(0.0, 0.0, 0.0) == 0.0


@pytest.mark.parametrize(("rays", "sky_rays"), [(8, 4), (1, 3), (16, 0)])
def test_both_kinds_of_rays_together_are_irradiance(rays, sky_rays):
    """A sky of radiance 1 with a spot of radiance 200: 60 000 rays of either kind, each weighted.

    Without the share of those by the cosine the spot alone would come twice.
    """
    axis = np.array([0.6, 0.0, 0.8])
    cap = 2.0 * np.pi * (1.0 - 0.995)
    radiance = lambda d: np.where(d @ axis > 0.995, 200.0, 1.0)  # noqa: E731
    power = 4.0 * np.pi + 199.0 * cap
    truth = np.pi + 199.0 * np.pi * (1.0 - 0.995**2) * 0.8
    total = 0.0
    samples = 60_000
    by_cosine = gather.cosine_direction(
        np.tile(UP, (samples * rays // 8, 1)), RNG.random((samples * rays // 8, 2))
    )
    for d, is_sky in ((by_cosine, False), (_by_brightness(samples, axis), True)):
        if is_sky and not sky_rays:
            continue
        count = sky_rays if is_sky else rays
        share = gather.sky_share(d[:, 2], radiance(d) / power, rays, sky_rays)
        total += count * float((share * radiance(d)).mean())
    tolerance = 0.01 if sky_rays else 0.15
    assert np.pi / rays * total == pytest.approx(truth, rel=tolerance)


def _by_brightness(count: int, axis: np.ndarray) -> np.ndarray:
    """Directions distributed as the radiance of the test's sky, by rejection."""
    found = np.empty((0, 3))
    while len(found) < count:
        z = RNG.normal(size=(40 * count, 3))
        z /= np.linalg.norm(z, axis=1, keepdims=True)
        bright = np.where(z @ axis > 0.995, 200.0, 1.0)
        found = np.concatenate([found, z[RNG.random(len(z)) < bright / 200.0]])
    return found[:count]


def test_items_of_an_alias_table_come_by_their_weights():
    weights = RNG.random(500) ** 8
    weights[::7] = 0.0
    keep, other = sampling.alias_table(weights)
    chance = keep / 500.0
    np.add.at(chance, other, (1.0 - keep) / 500.0)
    np.testing.assert_allclose(chance, weights / weights.sum(), atol=1e-12)
    np.testing.assert_allclose(sampling.alias_table(np.zeros(4))[0], 1.0)


def test_light_from_afar_is_shared_beside_a_wall_and_not_through_it():
    """Half of both points' rays meet a wall .1 m from them, others something 10 m away."""
    left, right = np.array([-5.0, 0.0, 0.0]), np.array([5.0, 0.0, 0.0])
    assert gather.far_closeness((0.2, 0.0, 0.0), 0.1, left, right) < 1e-10
    assert gather.far_closeness((0.1, 0.3, 0.0), 0.1, left, left) > 0.9
    assert gather.far_closeness((-0.2, 0.0, 0.0), 0.1, left, right) > 0.95
    assert gather.far_closeness((0.0, 0.0, 1.0), 0.1, left, right) == pytest.approx(np.exp(-1.0))


@pytest.mark.parametrize("g", [0.0, 0.7, -0.5])
def test_directions_about_a_lobe_have_its_density(g):
    """Weighted by it they have no mean direction; unweighted half the mean cosine of the lobe."""
    axis = np.array([0.48, 0.6, 0.64])
    d = gather.lobe_direction(np.tile(axis, (200_000, 1)), g, RNG.random((200_000, 2)))
    np.testing.assert_allclose(np.linalg.norm(d, axis=-1), 1.0, atol=1e-12)
    weight = 1.0 / (4.0 * np.pi * gather.lobe_density(d @ axis, g))
    # Weights lie below 2: deviations of 200 000 are below .005.
    np.testing.assert_allclose(weight.mean(), 1.0, atol=0.01)
    np.testing.assert_allclose((weight[:, None] * d).mean(axis=0), 0.0, atol=0.01)
    np.testing.assert_allclose((d @ axis).mean(), 0.5 * g, atol=0.01)


def test_twins(wgsl):
    n = fibonacci_sphere(500)
    x, y, k = (RNG.integers(0, 5000, 500).astype(np.uint32) for _ in range(3))
    numbers = wgsl("gather", "ray_numbers", x, y, k, returns="vec2f")
    np.testing.assert_array_equal(numbers, gather.ray_numbers(x, y, k).astype(np.float32))
    segment = k % 5 + 1
    later = wgsl("gather", "later_numbers", x, y, k, segment, returns="vec2f")
    twin = gather.later_numbers(x, y, k, segment)
    np.testing.assert_array_equal(later, twin.astype(np.float32))
    u = RNG.random((500, 2))
    found = wgsl("gather", "cosine_direction", n, u, returns="vec3f")
    np.testing.assert_allclose(found, gather.cosine_direction(n, u), atol=2e-4)
    found = wgsl("gather", "sphere_direction", u, returns="vec3f")
    np.testing.assert_allclose(found, gather.sphere_direction(u), atol=2e-4)
    g = RNG.uniform(-0.9, 0.9, 500)
    found = wgsl("gather", "lobe_direction", n, g, u, returns="vec3f")
    np.testing.assert_allclose(found, gather.lobe_direction(n, g, u), atol=5e-4)
    found = wgsl("gather", "lobe_density", n[:, 0], g, returns="f32")
    np.testing.assert_allclose(found, gather.lobe_density(n[:, 0], g), rtol=1e-4)
    p, q = RNG.normal(size=(2, 500, 3))
    m, texel = fibonacci_sphere(500)[::-1], RNG.random(500) + 0.5
    like = wgsl("gather", "likeness", p, n, q, m, texel, returns="f32")
    np.testing.assert_allclose(like, gather.likeness(p, n, q, m, texel), rtol=2e-3, atol=1e-6)
    near = gather.nearness(n, texel, u[:, 0])
    found = wgsl("gather", "nearness", n, texel, u[:, 0], returns="mat2x3f")
    np.testing.assert_allclose(found, np.stack(near, axis=1), rtol=1e-4, atol=1e-6)
    close = wgsl("gather", "closeness", 0.1 * p, *near, returns="f32")
    np.testing.assert_allclose(close, gather.closeness(0.1 * p, *near), rtol=1e-3, atol=1e-6)
    close = wgsl("gather", "far_closeness", 0.1 * p, u[:, 1], n, m, returns="f32")
    twin = gather.far_closeness(0.1 * p, u[:, 1], n, m)
    np.testing.assert_allclose(close, twin, rtol=1e-3, atol=1e-6)
    alike = wgsl("gather", "far_likeness", 0.5 * like, n, m, returns="f32")
    np.testing.assert_allclose(alike, gather.far_likeness(0.5 * like, n, m), rtol=2e-3, atol=1e-6)
    along = wgsl("gather", "flux_along", n, m, returns="vec3f")
    np.testing.assert_allclose(along, gather_turning.flux_along(n, m), rtol=1e-3, atol=1e-5)
    a, b = np.exp(RNG.normal(size=(2, 500)))
    spread = wgsl("gather", "variance_of_sum", a, a * a, x % 9 + 1, returns="f32")
    twin = [gather.variance_of_sum(s, s * s, int(i)) for s, i in zip(a, x % 9 + 1, strict=True)]
    np.testing.assert_allclose(spread, twin, rtol=1e-3, atol=1e-5)
    same = wgsl("gather", "sameness", a, b, b, returns="f32")
    np.testing.assert_allclose(same, gather.sameness(a, b, b), rtol=1e-3, atol=1e-6)
    three = np.exp(RNG.normal(size=(3, 500, 3)))
    flux, normal = three[0] - three[1], three[2] / np.linalg.norm(three[2], axis=-1, keepdims=True)
    turned = wgsl("gather", "turn_ratio", flux, normal, returns="f32")
    np.testing.assert_allclose(
        turned, gather_turning.turn_ratio(flux, normal), rtol=1e-4, atol=1e-6
    )
    detail = wgsl("gather", "detailed", *three, returns="vec3f")
    np.testing.assert_allclose(detail, gather_turning.detailed(*three), rtol=1e-5)
    shares = np.exp(RNG.normal(size=(3, 500)))
    factor = wgsl("gather", "calibration", *shares, returns="f32")
    twin = [gather.calibration(*map(float, row)) for row in shares.T]
    np.testing.assert_allclose(factor, twin, rtol=1e-4)
    share = wgsl("gather", "sky_share", u[:, 0], u[:, 1], x, y, returns="f32")
    twin = [gather.sky_share(a, b, int(i), int(j)) for a, b, i, j in zip(*u.T, x, y, strict=True)]
    np.testing.assert_allclose(share, twin, rtol=1e-4)
