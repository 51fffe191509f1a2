"""The diffusion operator: symmetric, conservative, and right where diffusion is exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.diffusion import Diffusion, diffusivity, largest_diffusivity, solve

RNG = np.random.default_rng(3)
SHAPE = (5, 6, 4, 2)
CELL = np.array([0.3, 0.2, 0.25])


def system(absorbing: bool = True) -> Diffusion:
    d = RNG.uniform(0.05, 2.0, SHAPE)
    return Diffusion(CELL, d, RNG.uniform(0.1, 1.0, SHAPE) if absorbing else np.zeros(SHAPE))


def test_the_operator_is_symmetric_and_its_diagonal_is_its_diagonal():
    a = system()
    u, v = RNG.normal(size=SHAPE), RNG.normal(size=SHAPE)
    left, right = (a.apply(u) * v).sum(axis=(0, 1, 2)), (u * a.apply(v)).sum(axis=(0, 1, 2))
    np.testing.assert_allclose(left, right, rtol=1e-12)
    unit = np.zeros(SHAPE)
    for index in [(0, 0, 0), (2, 3, 1), (4, 5, 3)]:
        unit[...] = 0.0
        unit[index] = 1.0
        np.testing.assert_allclose(a.apply(unit)[index], a.diagonal()[index], rtol=1e-12)


def test_power_in_is_power_out():
    a = system()
    power, forward = RNG.random(SHAPE), RNG.normal(size=(3, *SHAPE)) * 0.3
    phi, residual = solve(a, a.source(power, forward), 400)
    assert residual.max() < 1e-9
    absorbed = (a.sigma_a * phi).sum(axis=(0, 1, 2)) * CELL.prod()
    out = a.exits(phi, forward).sum(axis=0) + absorbed
    np.testing.assert_allclose(out, power.sum(axis=(0, 1, 2)), rtol=1e-7)


def test_a_slab_lit_evenly_is_the_parabola_of_diffusion_theory():
    """Source q between open faces: Phi = q (L x - x^2)/(2 D) + q L (Marshak: Phi = 2 J)."""
    n, length, d, q = 40, 2.0, 0.05, 3.0
    # Wide in y and z, so that only the middle column is a slab: 1 cell with huge extent.
    cell = np.array([length / n, 1e6, 1e6])
    a = Diffusion(cell, np.full((1, 1, n, 1), d), np.zeros((1, 1, n, 1)))
    power = np.full((1, 1, n, 1), q * cell.prod())
    forward = np.zeros((3, 1, 1, n, 1))
    phi, _ = solve(a, a.source(power, forward), 200)
    x = (np.arange(n) + 0.5) * cell[0]
    want = q * (length * x - x * x) / (2.0 * d) + q * length
    np.testing.assert_allclose(phi[0, 0, :, 0], want, rtol=4e-3)
    flux = a.flux(phi, forward)[0, 0, 0, :, 0]
    np.testing.assert_allclose(flux, q * (x - 0.5 * length), atol=1e-3)


def test_dark_channels_stay_dark_and_steps_help():
    a = system()
    power = RNG.random(SHAPE) * [1.0, 0.0]
    rhs = a.source(power, np.zeros((3, *SHAPE)))
    phi, residual = solve(a, rhs, 30)
    assert np.all(phi[..., 1] == 0.0)
    assert residual[1] == 0.0
    assert residual[0] < solve(a, rhs, 8)[1][0]


def test_the_cap_is_a_third_of_a_balls_radius():
    at = (np.arange(40) + 0.5) / 20 - 1.0
    z, y, x = np.meshgrid(at, at, at, indexing="ij")
    ball = (x * x + y * y + z * z < 0.64).astype(float)
    cap = largest_diffusivity(ball, np.full(3, 0.1))  # 4 m wide: the radius is 1.6 m
    assert cap == pytest.approx(1.6 / 3.0, rel=0.02)
    assert largest_diffusivity(np.zeros((2, 2, 2)), np.ones(3)) > 0.0
    d = diffusivity(np.array([[[0.0, 1.0]]]), [3.0], [1.0], 0.5)
    np.testing.assert_allclose(d[0, 0, :, 0], [0.5, 1 / 12])


def test_the_cap_follows_the_thin_sides_however_they_are_turned():
    """A plate's radius is nearer its thickness than its width; a turned one has the same."""
    at = (np.arange(48) + 0.5) / 24 - 1.0
    z, y, x = np.meshgrid(at, at, at, indexing="ij")

    def cap(across: np.ndarray, along: np.ndarray) -> float:
        plate = (np.abs(across) < 0.125) & (np.abs(along) < 0.625) & (np.abs(z) < 0.625)
        return largest_diffusivity(plate.astype(float), np.full(3, 2.0 / 48))

    straight = cap(x, y)
    radii = np.sqrt(5.0 / 3.0) * np.array([0.125, 0.625, 0.625])  # of a box of these half sides
    assert straight == pytest.approx(np.sqrt(3.0 / (radii**-2.0).sum()) / 3.0, rel=0.05)
    half = np.sqrt(0.5)
    assert cap(half * (x + y), half * (x - y)) == pytest.approx(straight, rel=0.08)


def walled() -> Diffusion:
    """A box whose third cell along x a wall keeps from the fourth, and a few faces at random."""
    a = system()
    closed = RNG.random((3, *SHAPE[:3])) < 0.1
    closed[0, :, :, 1] = True
    for axis in range(3):
        closed[axis].swapaxes(2 - axis, 0)[-1] = False
    return replace(a, closed=closed, reflectance=RNG.uniform(0.0, 0.9, (3, 2, *SHAPE[:3])))


def test_walls_keep_the_operator_symmetric_and_what_is_behind_them_dark():
    a = walled()
    u, v = RNG.normal(size=SHAPE), RNG.normal(size=SHAPE)
    left, right = (a.apply(u) * v).sum(axis=(0, 1, 2)), (u * a.apply(v)).sum(axis=(0, 1, 2))
    np.testing.assert_allclose(left, right, rtol=1e-12)
    unit = np.zeros(SHAPE)
    unit[2, 3, 1] = 1.0
    np.testing.assert_allclose(a.apply(unit)[2, 3, 1], a.diagonal()[2, 3, 1], rtol=1e-12)
    power, forward = np.zeros(SHAPE), np.zeros((3, *SHAPE))
    power[:, :, :2] = 1.0
    phi, _ = solve(a, a.source(power, forward), 400)
    assert phi[:, :, :2].min() > 0.0
    assert np.all(phi[:, :, 2:] == 0.0)


@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_a_slab_between_walls_is_brighter_by_what_they_reflect(rho):
    """Marshak's condition with reflection: Phi = 2 J (1 + rho)/(1 - rho) on the walls."""
    n, length, d, q = 40, 2.0, 0.05, 3.0
    cell = np.array([length / n, 1e6, 1e6])
    closed = np.zeros((3, 1, 1, n + 2), bool)
    closed[0, 0, 0, [0, n]] = True
    a = Diffusion(
        cell,
        np.full((1, 1, n + 2, 1), d),
        np.zeros((1, 1, n + 2, 1)),
        closed,
        np.full((3, 2, 1, 1, n + 2), rho),
    )
    power = np.full((1, 1, n + 2, 1), q * cell.prod())
    phi, _ = solve(a, a.source(power, np.zeros((3, 1, 1, n + 2, 1))), 200)
    x = (np.arange(n) + 0.5) * cell[0]
    want = q * (length * x - x * x) / (2.0 * d) + q * length * (1.0 + rho) / (1.0 - rho)
    np.testing.assert_allclose(phi[0, 0, 1:-1, 0], want, rtol=4e-3)
