"""Lamps: the near field against exact transport, balls of air against Monte Carlo."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import delta_beam as db
from airlight.maths.diffusion import largest_diffusivity
from airlight.maths.point_light_beam import (
    NEAR_TABLE,
    axis_share,
    inner_share,
    local_sharpness,
    mean_inverse_square,
    near_fluence,
    near_table,
    point_light_beam,
)
from airlight.maths.transforms import F64
from airlight.maths.voxels import box_averaged

RADIUS, CELLS = 2.5, 20
SIGMA = np.array([0.8, 1.0, 1.3])


def ball(g: float) -> db.MediumGrid:
    """Elek2014, Fig. 10: a ball of 2.5 m, albedo 1."""
    at = (np.arange(4 * CELLS) + 0.5) / (2 * CELLS) - 1.0
    inside = at[:, None, None] ** 2 + at[:, None] ** 2 + at**2 <= 1.0
    fine = box_averaged(inside.astype(float), (2 * CELLS,) * 3)
    coarse = fine.reshape(CELLS, 2, CELLS, 2, CELLS, 2).mean(axis=(1, 3, 5))
    extent = np.full(3, 2.0 * RADIUS)
    return db.MediumGrid(extent, coarse, fine, SIGMA, np.ones(3), np.full(3, g))


def scattered(air: db.MediumGrid, position: tuple[float, float, float]) -> F64:
    """Fluence of light scattered at least once by a lamp of 1 W sr^-1."""
    one = point_light_beam(air, np.array(position) + RADIUS, np.ones(3))
    radius = 3.0 * largest_diffusivity(air.density, air.cell)
    away = np.linalg.norm(air.centres - position - RADIUS, axis=-1)
    near = near_fluence(air, one, away, np.ones(3), radius, 1.0)
    return np.asarray(db.light(air, [one]).scattered_fluence() + near)


def test_the_near_field_is_the_known_limit_and_holds_what_diffusion_lost():
    table = near_table(1.0)
    assert table[0] == pytest.approx(np.pi**2 / 4.0, rel=2e-3)
    assert table[-1] == 0.0
    # Moments of the transport equation: the missing fluence sums to .8 of the beam's.
    x = np.linspace(0.0, 1.0, NEAR_TABLE)[:-1]
    s = x / (1.0 - x)
    fine = np.linspace(0.0, 15.0, 4000)
    missing = fine * np.interp(fine, s, table[:-1])
    assert np.trapezoid(missing, fine) == pytest.approx(0.8, rel=0.02)
    assert near_table(0.5)[0] == pytest.approx(np.pi**2 / 4.0, rel=2e-3)


def test_a_cells_share_of_a_light_is_its_mean():
    at = (np.arange(40) + 0.5) / 40 - 0.5
    z, y, x = np.meshgrid(at, at, at, indexing="ij")
    for centre in [(0.5, 0.5, 0.5), (1.5, 0.5, 0.5), (3.0, 2.0, 0.0)]:
        r2 = (x + centre[0]) ** 2 + (y + centre[1]) ** 2 + (z + centre[2]) ** 2
        got = mean_inverse_square(np.array(centre), np.ones(3))
        assert got == pytest.approx((1.0 / r2).mean(), rel=0.12 if centre[0] < 1 else 0.03)


@pytest.mark.parametrize("sigma", [0.5, 1.5, 4.0])
@pytest.mark.parametrize("position", [(2.0, 2.0, 2.0), (2.1, 1.9, 1.55), (2.2, 1.0, 2.4)])
def test_what_leaves_the_beam_of_a_light_is_conserved(sigma, position):
    """A cube of 4 m, 20^3 cells: a sixth was lost at .8 mean free paths a cell."""
    shape, extent = (20,) * 3, np.full(3, 4.0)
    absorbing, g = np.full(1, 0.95), np.zeros(1)
    air = db.MediumGrid(extent, np.ones(shape), np.ones(shape), np.full(1, sigma), absorbing, g)
    power, _ = db.deposit(air, [point_light_beam(air, position, np.ones(1))])
    # Along rays in all directions: 1 - exp(-sigma t), t to the cube's side.
    d = np.random.default_rng(1).normal(size=(100_000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    t = (np.where(d > 0.0, extent - position, -np.array(position)) / d).min(axis=1)
    wanted = 4.0 * np.pi * 0.95 * -np.expm1(-sigma * t).mean()
    assert power[..., 0].sum() == pytest.approx(wanted, rel=0.02)


def test_a_light_far_beside_is_not_one_in_the_medium():
    size = (4.0, 3.0, 4.0)
    assert inner_share((2.0, 3.0, 0.0), size, 2.0) == 1.0
    assert inner_share((2.0, 4.0, 2.0), size, 2.0) == pytest.approx(0.5)
    assert inner_share((2.0, 5.5, 2.0), size, 2.0) == 0.0


def test_the_shader_knows_how_far_a_light_is_in_a_medium(wgsl):
    rng = np.random.default_rng(4)
    position = rng.uniform(-4.0, 8.0, (200, 3)).astype(np.float32)
    extent, radius = rng.uniform(1.0, 5.0, (200, 3)), rng.uniform(0.5, 3.0, 200)
    found = wgsl("inner_share", "inner_share", position, extent, radius)
    rows = zip(position, extent, radius, strict=True)
    expected = np.array([inner_share(p, e, float(r)) for p, e, r in rows])
    assert 20 < (expected == 0.0).sum() < 180 and (expected == 1.0).any()
    np.testing.assert_allclose(found, expected, atol=1e-5)


# Scattered fluence, W m^-2, of 1 W sr^-1 at the middle of the ball at sigma_s .8 and 1.3, by
# airlight.reference.tracer with 400,000 photons: means over the cells at
# r < .8, .8 to 1.6 and 1.6 to 2.3 m.
MEANS = {
    0.0: ((3.4346, 1.1523, 0.4768), (5.6341, 1.8118, 0.6884)),
    0.5: ((2.0059, 0.7069, 0.3366), (3.177, 1.0564, 0.462)),
    0.9: ((1.3269, 0.4523, 0.2283), (1.9441, 0.5946, 0.277)),
}


@pytest.mark.parametrize("g", MEANS)
def test_a_ball_around_a_light_has_the_fluence_of_monte_carlo(g):
    air = ball(g)
    got, r = scattered(air, (0.0, 0.0, 0.0)), np.linalg.norm(air.centres - RADIUS, axis=-1)
    for channel, means in zip((0, 2), MEANS[g], strict=True):
        shells = zip((0.0, 0.8, 1.6), (0.8, 1.6, 2.3), strict=True)
        mine = [got[(r >= a) & (r < b), channel].mean() for a, b in shells]
        np.testing.assert_allclose(mine, means, rtol=0.12)


@pytest.mark.slow
@pytest.mark.parametrize("g", [0.0, 0.5, 0.7, 0.9, 0.96])
@pytest.mark.parametrize("x", [0.0, 1.25])
@pytest.mark.needs("numba")
def test_a_ball_with_a_light_anywhere_is_close_to_monte_carlo(g, x):
    """Relative L2: measured .03 to .09 at 20^3, centred or half way out."""
    from airlight.reference.tracer import BoxMedium, PointSource, trace

    air = ball(g)
    got = scattered(air, (x, 0.0, 0.0))
    inside = air.density > 0.5
    for channel in (0, 2):
        box = BoxMedium(SIGMA[channel], 1.0, g, ((-RADIUS,) * 3, (RADIUS,) * 3), shape="sphere")
        light = trace(box, PointSource((x, 0.0, 0.0)), cells=(CELLS,) * 3, photons=300_000)
        want = light.scattered_fluence[inside]
        error = np.sqrt(((got[inside, channel] - want) ** 2).sum() / (want**2).sum())
        assert error < 0.12


def test_a_light_outside_is_nearly_parallel_light():
    """Ten metres away a lamp of I is a sun of I/100 W m^-2."""
    air = ball(0.5)
    far = scattered(air, (0.0, 0.0, -10.0))
    sun = db.light(air, [db.beam(air, (0.0, 0.0, 1.0), np.full(3, 0.01), 1.0)])
    ratio = far[air.density > 0.5].mean() / sun.scattered_fluence()[air.density > 0.5].mean()
    assert ratio == pytest.approx(1.0, abs=0.1)


def test_a_spots_axis_is_as_far_in_the_box_as_it_is():
    size, below = (1.0, 1.0, 1.0), (0.5, -0.25, 0.5)
    points = np.array([[0.5, 0.5, 0.5], [0.5, 0.2, 0.1], [0.9, 0.9, 0.9]])
    np.testing.assert_allclose(axis_share(below, (0.0, 1.0, 0.0), size, points), 1.0, atol=0.01)
    assert not axis_share(below, (0.0, -1.0, 0.0), size, points).any()
    assert not axis_share(below, (1.0, 0.0, 0.0), size, points).any()
    # Inside, near a face and towards it: 0.1 m of the 0.5 to the middle.
    inside = axis_share((0.5, 0.1, 0.5), (0.0, -1.0, 0.0), size, np.array([0.5, 0.6, 0.5]))
    assert inside == pytest.approx(0.2)


@pytest.mark.parametrize(("distance", "spread"), [(0.0, 0.3), (0.2, 0.3), (0.7, 0.1), (2.0, 0.3)])
def test_directions_in_a_cell_beside_a_light(distance: float, spread: float) -> None:
    """The mean cosine to the path between the middles, of points of a ball and of a cell."""
    rng, n = np.random.default_rng(5), 200_000
    cell = np.array([0.3, 0.2, 0.25])
    away = rng.normal(size=(n, 3))
    away *= (np.sqrt(5.0 / 3.0) * spread * np.cbrt(rng.random(n)) / np.linalg.norm(away, axis=1))[
        :, None
    ]
    towards = np.array([0.0, 0.0, distance]) + (rng.random((n, 3)) - 0.5) * cell - away
    cosine = float((towards[:, 2] / np.linalg.norm(towards, axis=1)).mean())
    assert local_sharpness(distance, spread, cell) == pytest.approx(cosine, abs=0.06)
