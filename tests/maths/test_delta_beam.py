"""The delta beam against Monte Carlo: cubes, a furnace, thin air, oblique light."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import delta_beam as db
from airlight.maths.medium import ray_box_interval
from airlight.maths.ordinates import uniform_sky
from airlight.maths.outgoing_light import forward_share
from airlight.maths.phase import henyey_greenstein
from airlight.maths.sampling import fibonacci_sphere, orthonormal_frame

from .pop_cubes import CUBES, VIEWS, intensity, medium

GROUPS = ([0, 1, 2], [3, 4, 5], [6, 0, 0])
FIRST = ([0, 1, 2], [0, 1, 2], [0])  # the channels of each group that count


def solved(cells: int) -> list[tuple[int, int, db.Solution]]:
    """(cube, channel, solution) of all seven cubes."""
    found = []
    for group, channels in zip(GROUPS, FIRST, strict=True):
        air = medium([CUBES[i] for i in group], cells)
        solution = db.light(air, [db.beam(air, (0, 0, 1), np.ones(3), 1.0)])
        found += [(group[c], c, solution) for c in channels]
    return found


@pytest.mark.parametrize("cells", [pytest.param(8, marks=pytest.mark.slow), 16])
def test_seven_cubes_have_the_brightness_and_fluence_of_monte_carlo(cells):
    """Mean |log| over side, forward, back views: measured .069 at 8^3, .070 at 16^3.

    The largest, .53, is what a fortieth of the light does behind a cube 30 deep; .15 elsewhere.
    """
    logs, fluence = [], []
    for cube, channel, solution in solved(cells):
        seen = [intensity(solution.medium, solution.emission(np.array(v)), v) for v in VIEWS]
        logs.append(np.log(np.array(seen)[:, channel] / CUBES[cube].intensity))
        mean = solution.scattered_fluence()[..., channel].mean()
        fluence.append(mean / CUBES[cube].fluence)
    assert np.abs(logs).mean() < 0.075
    assert np.sort(np.abs(logs).ravel())[-1] < 0.54
    assert np.sort(np.abs(logs).ravel())[-2] < 0.16
    np.testing.assert_allclose(fluence, 1.0, atol=0.1)


def test_scattered_light_leaves_by_the_right_faces():
    """Diffuse light through the open faces, quasi-forward light through the far one."""
    errors = []
    for cube, channel, solution in solved(16):
        air, c = solution.medium, CUBES[cube]
        system = db.diffusion_of(air)
        out = system.exits(solution.fluence, db.deposit(air, solution.beams)[1])[:, channel]
        tau = air.sigma_t[channel]
        kept = db.beam_loss(air.g, air.albedo)[channel]
        out[5] += np.exp(-kept * tau) - np.exp(-tau)
        got = np.array([out[4], out[5], out[:4].sum()])
        absorbed = solution.scattered_fluence()[..., channel].mean() * c.sigma_a
        absorbed += (1.0 - np.exp(-tau)) * c.sigma_a / tau
        assert got.sum() + np.exp(-tau) + absorbed == pytest.approx(1.0, abs=0.03)
        errors.append(got - c.exits)
    # Light goes forwards too much and sideways too little, most at g = .9, sigma_s = 10.
    assert np.abs(errors).max() < 0.13, np.round(errors, 3)
    assert np.abs(errors).mean() < 0.05, np.abs(errors).mean()


@pytest.mark.slow
@pytest.mark.parametrize("cells", [8, 16, 32])
@pytest.mark.needs("numba")
def test_seven_cubes_have_the_fluence_of_monte_carlo(cells):
    """Relative L2 of scattered fluence: measured .129 at 16^3."""
    from airlight.reference.tracer import Beam, BoxMedium, trace

    errors = []
    for cube, channel, solution in solved(cells):
        c = CUBES[cube]
        sigma_t = c.sigma_s + c.sigma_a
        light = trace(
            BoxMedium(sigma_t, c.sigma_s / sigma_t, c.g),
            Beam((0, 0, 1)),
            cells=(8, 8, 8),
            photons=400_000,
        )
        got = solution.scattered_fluence()[..., channel]
        f = cells // 8
        got = got.reshape(8, f, 8, f, 8, f).mean(axis=(1, 3, 5))
        want = light.scattered_fluence
        errors.append(np.sqrt(((got - want) ** 2).sum() / (want**2).sum()))
    assert np.mean(errors) < 0.135, np.round(errors, 3)


@pytest.mark.parametrize("travel", [(0.0, 0.0, 1.0), (0.48, -0.64, 0.6)])
def test_thin_air_scatters_once(travel):
    """Optical depth .02, straight and oblique light: the analytic single scattering within 3%."""
    air = db.MediumGrid(
        np.ones(3),
        np.ones((12,) * 3),
        np.ones((24,) * 3),
        np.full(3, 0.02),
        np.ones(3),
        np.array([0.0, 0.6, 0.9]),
    )
    solution = db.light(air, [db.beam(air, travel, np.ones(3), 1.0)])
    for view in ((0.6, 0.0, -0.8), (0.0, 0.8, 0.6), travel):
        seen = intensity(air, solution.emission(np.array(view)), view)
        want = 0.02 * henyey_greenstein(np.dot(travel, view), air.g)
        np.testing.assert_allclose(seen, want, rtol=0.03)


def test_a_blob_vanishes_in_a_white_furnace():
    """Radiance 1 from everywhere: what it scatters to any eye is 1, within a tenth on average."""
    at = (np.arange(14) + 0.5) / 14 - 0.5
    radius = np.sqrt(at[:, None, None] ** 2 + at[:, None] ** 2 + at**2)
    rho = np.clip((0.45 - radius) / 0.15, 0.0, 1.0)
    air = db.MediumGrid(
        np.ones(3), rho, rho, np.full(3, 10.0), np.ones(3), np.array([0.0, 0.7, 0.9])
    )
    sky = uniform_sky(48)
    beams = [
        db.beam(air, *row)
        for row in zip(sky.direction, sky.irradiance, sky.mean_cosine, strict=True)
    ]
    solution = db.light(air, beams)
    weight = rho[..., None] / rho.sum()
    total = solution.scattered_fluence() + sum(solution.quasi_forward(b)[0] for b in beams)
    np.testing.assert_allclose((weight * total).sum(axis=(0, 1, 2)) / (4 * np.pi), 1.0, atol=0.06)
    for eye in ((0.6, 0.48, 0.64), (0.0, 0.0, 1.0)):
        seen = solution.emission(np.array(eye))
        np.testing.assert_allclose((weight * seen).sum(axis=(0, 1, 2)), 1.0, atol=0.06)
        assert np.sqrt((weight * (seen - 1.0) ** 2).sum(axis=(0, 1, 2))).max() < 0.12


@pytest.mark.parametrize("sigma_t", [2.0, 8.0, 30.0])
@pytest.mark.parametrize("travel", [(0.0, 0.0, 1.0), (0.48, -0.64, 0.6)])
def test_a_beam_leaves_the_power_it_should(sigma_t, travel):
    """Of light on a box, all that does not come out behind it: sigma_t 1.5 per cell at most."""
    extent = np.array([1.0, 1.5, 0.8])
    one = np.ones((16, 30, 20))
    air = db.MediumGrid(extent, one, one, np.full(3, sigma_t), np.ones(3), np.zeros(3))
    power, forward = db.deposit(air, [db.beam(air, travel, np.ones(3), 1.0)])
    want = (np.asarray(travel) * extent.prod() / extent) @ np.sign(travel)
    want -= box_transmitted(extent, travel, sigma_t)
    assert power.sum(axis=(0, 1, 2))[0] == pytest.approx(want, rel=0.04)
    assert np.abs(forward).max() == 0.0  # isotropic scattering carries nothing on


def box_transmitted(extent, travel, sigma_t):
    """Power of a beam of 1 W m^-2 behind a box: rays through its shadow."""
    d = np.asarray(travel)
    frame = np.stack([*orthonormal_frame(d), d])
    half = np.abs(frame) @ (0.5 * extent)
    u, v = np.meshgrid(*[(np.arange(300) + 0.5) / 150 - 1.0] * 2)
    o = 0.5 * extent + u[..., None] * half[0] * frame[0] + v[..., None] * half[1] * frame[1]
    t0, t1 = ray_box_interval(o, d, np.zeros(3), extent)
    through = np.where(t1 > t0, np.exp(-sigma_t * np.where(t1 > t0, t1 - t0, 0.0)), 0.0)
    return through.sum() * 4.0 * half[0] * half[1] / 300**2


def test_backward_scattering_and_empty_air():
    air = db.MediumGrid(
        np.ones(3),
        np.ones((6,) * 3),
        np.ones((6,) * 3),
        np.full(3, 3.0),
        np.ones(3),
        np.array([-0.6, 0.0, 0.9]),
    )
    beams = [db.beam(air, (0, 0, 1), np.ones(3), 1.0)]
    seen = [intensity(air, db.light(air, beams).emission(np.array(v)), v) for v in VIEWS]
    assert np.isfinite(seen).all()
    assert seen[2][0] > seen[1][0]  # g < 0: brighter towards the light
    empty = db.MediumGrid(
        np.ones(3), np.zeros((4,) * 3), np.zeros((4,) * 3), np.ones(3), np.ones(3), np.zeros(3)
    )
    dark = db.light(empty, [db.beam(empty, (0, 0, 1), np.ones(3), 1.0)])
    assert dark.scattered_fluence().max() == 0.0


def test_quasi_forward_light_is_continuous_where_its_series_takes_over():
    g = np.array([0.3, 0.8, 0.99])
    around = [db.quasi_forward_anisotropy(g, 1.0, t / forward_share(g)) for t in (0.00999, 0.01001)]
    np.testing.assert_allclose(around[0], around[1], rtol=1e-4)
    np.testing.assert_allclose(db.quasi_forward_anisotropy(g, 1.0, 0.0), (1 + 2 * g) / 3)


@pytest.mark.parametrize("count", [16, 64])
def test_the_sharpest_lobes_of_an_uniform_sky_sum_up_without_spots(count):
    """Any lobe integrates to 1; sharper ones would show each ordinate."""
    sky = uniform_sky(count)
    views = fibonacci_sphere(400)
    cosines = -(views @ sky.direction.T)
    lobe = db.resolved_by(sky.mean_cosine)
    assert lobe.mean() == pytest.approx(0.05 ** (1.0 / np.sqrt(count)), abs=0.02)

    def ripple(sharpness):
        seen = (henyey_greenstein(cosines, sharpness) * sky.irradiance[:, 0]).sum(axis=1)
        return np.abs(seen - 1.0).max()

    assert ripple(lobe) < 0.1
    assert ripple(0.5 + 0.5 * lobe) > 0.2
    assert db.resolved_by(1.0) == 1.0
