"""Our Monte Carlo tracer against what is known: limits, quadrature, energy, measured exits."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from airlight.errors import ReferenceFailure
from airlight.reference import quadrature, tracer
from airlight.reference.tracer import (
    Beam,
    BoxMedium,
    Emitting,
    IsotropicEnvironment,
    PointSource,
    trace,
)
from airlight.reference.tracer_setup import Slice
from airlight.scene import Emission, Medium, Volume

pytestmark = pytest.mark.needs("numba")

# Scattered light out of the unit cube by the face it was lit through, the opposite one and the
# four sides; sigma_s, sigma_a, g; measured by another program, rounded to .001.
EXITS = {
    (4.0, 0.0, 0.0): (0.326, 0.055, 0.600),
    (4.0, 0.0, 0.7): (0.096, 0.226, 0.660),
    (4.0, 0.0, 0.96): (0.009, 0.716, 0.256),
    (1.0, 0.0, 0.9): (0.006, 0.468, 0.158),
    (10.0, 0.0, 0.9): (0.070, 0.257, 0.673),
    (30.0, 0.0, 0.9): (0.209, 0.064, 0.727),
    (8.0, 2.0, 0.9): (0.020, 0.035, 0.175),
}


def scattered_exits(sigma_s, sigma_a, g, photons):
    """(entry, far, sides) and their standard errors."""
    sigma_t = sigma_s + sigma_a
    light = trace(
        BoxMedium(sigma_t, sigma_s / sigma_t, g), Beam((0, 0, 1)), cells=(1, 1, 1), photons=photons
    )
    e, v = light.scattered_exits, np.sum(light.exits_error[1:] ** 2, axis=0)
    return np.array([e[4], e[5], e[:4].sum()]), np.sqrt([v[4], v[5], v[:4].sum()])


@pytest.mark.parametrize("case", EXITS)
def test_a_unit_cube_lets_out_the_measured_shares(case):
    got, error = scattered_exits(*case, photons=60_000)
    assert np.all(np.abs(got - EXITS[case]) < 4.0 * error + 0.001), (got, error)


@pytest.mark.slow
@pytest.mark.parametrize("case", EXITS)
def test_a_unit_cube_lets_out_the_measured_shares_to_the_third_digit(case):
    got, error = scattered_exits(*case, photons=4_000_000)
    assert np.all(np.abs(got - EXITS[case]) < 4.0 * error + 0.001), (got, error)


def test_what_goes_in_comes_out_or_is_absorbed():
    light = trace(BoxMedium(5.0, 0.7, 0.5), PointSource((0.4, 0.5, 0.6)), photons=20_000)
    assert light.entered == pytest.approx(4 * math.pi)
    assert light.exits.sum() + light.absorbed == pytest.approx(light.entered, rel=1e-4)
    # Absorbed power is sigma_a times fluence: two estimators of one number.
    absorbed = 5.0 * 0.3 * light.fluence.sum() / 16**3
    assert absorbed == pytest.approx(light.absorbed, abs=6 * light.absorbed_error)


def test_albedo_zero_is_beer_lambert():
    light = trace(BoxMedium(2.0, 0.0), Beam((0, 0, 1)), cells=(8, 2, 3), photons=50_000)
    edges = np.linspace(0, 1, 9)
    want = -np.diff(np.exp(-2.0 * edges)) / (2.0 * np.diff(edges))
    deviation = np.abs(light.fluence[0] - want[:, None, None])
    assert np.all(deviation < 5 * light.fluence_error[0] + 1e-9)
    np.testing.assert_allclose(light.flux[0, ..., 2], light.fluence[0])
    assert light.scattered_fluence.max() == 0.0
    assert light.exits[0, 5] == pytest.approx(math.exp(-2), abs=5 * light.exits_error[0, 5])


def test_a_white_furnace_is_even():
    light = trace(
        BoxMedium(3.0, 1.0, 0.6), IsotropicEnvironment(2.0), cells=(2, 3, 4), photons=60_000
    )
    fluence, irradiance = quadrature.white_furnace(2.0)
    error = np.sqrt(np.sum(light.fluence_error**2, axis=0))
    assert np.all(np.abs(light.fluence.sum(axis=0) - fluence) < 6 * error)
    np.testing.assert_allclose(light.exits.sum(axis=0), irradiance, rtol=0.02)


@pytest.mark.parametrize("g", [0.0, 0.8, -0.5])
def test_brightness_scattered_once_is_the_quadrature(g):
    travel = (0.36, -0.8, 0.48)
    views = [(0.0, 0.0, 1.0), (0.6, 0.8, 0.0), (-0.48, -0.36, -0.8)]
    light = trace(BoxMedium(1.5, 0.7, g), Beam(travel, 3.0), photons=40_000, views=views)
    cube = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    want = [
        quadrature.box_single_scatter_intensity(travel, v, 3.0, 1.5, 0.7, g, cube) for v in views
    ]
    assert np.all(np.abs(light.brightness[0] - want) < 4.5 * light.brightness_error[0])


def test_a_thin_medium_is_its_single_scattering():
    """Optical depth .02: light scattered twice is a hundredth of light scattered once."""
    light = trace(BoxMedium(0.02), Beam((0, 0, 1)), photons=100_000, views=[(1, 0, 0)])
    once, more = light.brightness[:, 0]
    assert once == pytest.approx(0.02 / (4 * math.pi), rel=0.1)
    assert 0.0 <= more < 0.05 * once


@pytest.mark.parametrize("kind", ["grid", "noise", "sphere"])
def test_a_grid_of_constant_density_is_homogeneous_and_a_mean_density_is_a_mean(kind):
    rng = np.random.default_rng(3)
    bounds = ((-1.0, 0.0, 2.0), (1.0, 1.5, 3.0))
    if kind == "sphere":
        volume = Volume(sigma_t=(0.7,) * 3, shape="sphere", bounds=bounds)
        # The mean of exp(-sigma chord) over an ellipse's shadow in its box, pi/4 of it.
        r2 = (np.arange(4000) + 0.5) / 4000
        inside = np.mean(np.exp(-0.7 * 1.0 * np.sqrt(1 - r2)))
        want = 1 - math.pi / 4 + math.pi / 4 * inside
    else:
        density = np.full((3, 4, 5), 1.5) if kind == "grid" else rng.random((3, 4, 5))
        volume = Volume(sigma_t=(0.7,) * 3, density=density.astype(np.float32), bounds=bounds)
        want = beer_through_columns(density, 0.7)
    light = trace(BoxMedium.of_volume(volume), Beam((0, 0, 1), 0.5 / 1.5), photons=200_000)
    assert light.entered == pytest.approx(1.0)
    assert light.exits[0, 5] == pytest.approx(want, abs=4 * light.exits_error[0, 5])


def beer_through_columns(density, sigma_t, fine=60):
    """Mean transmittance along z of a voxel-centred trilinear grid 1 m deep, by brute force."""
    from scipy.ndimage import map_coordinates

    axes = [(np.arange(fine) + 0.5) / fine * n - 0.5 for n in density.shape]
    at = np.stack(np.meshgrid(*axes, indexing="ij"))
    fine_density = map_coordinates(density, at, order=1, mode="nearest")
    return float(np.mean(np.exp(-sigma_t * fine_density.mean(axis=0))))


def test_directions_in_a_slice_add_up_to_the_fluence():
    plane = Slice(axis=1, layer=2)
    light = trace(
        BoxMedium(4.0, 1.0, 0.7), Beam((0, 0, 1)), cells=(4, 5, 3), photons=20_000, plane=plane
    )
    assert light.slice_radiance.shape == (2, 4, 3, 5, 36)
    solid_angle = 4 * math.pi / (5 * 36)
    total = light.slice_radiance.sum(axis=(-1, -2)) * solid_angle
    np.testing.assert_allclose(total[0], light.fluence[0, :, 2])
    np.testing.assert_allclose(total[1], light.scattered_fluence[:, 2])
    # Unscattered light travels along +z: cosine 0 to y, azimuth 90 degrees from x to z.
    assert np.flatnonzero(light.slice_radiance[0].sum(axis=(0, 1))).tolist() == [2 * 36 + 9]


def test_a_seed_gives_the_same_bits_and_another_seed_others():
    one, two, other = (
        trace(BoxMedium(4.0), Beam((0, 0, 1)), photons=3000, seed=s) for s in (7, 7, 8)
    )
    assert np.array_equal(one.fluence, two.fluence)
    assert not np.array_equal(one.fluence, other.fluence)


def test_a_pencil_and_a_distant_point_bring_the_power_they_should():
    pencil = Beam((0, 0, 1), 4.0, window=((0.25, 0.25, -1.0), (0.5, 0.75, 1.0)))
    light = trace(BoxMedium(0.0), pencil, cells=(1, 4, 4), photons=4000)
    assert light.entered == pytest.approx(4.0 * 0.125)
    assert np.flatnonzero(light.fluence[0, 0]).tolist() == [5, 9]
    far = trace(BoxMedium(0.0), PointSource((0.5, 0.5, -3.0)), cells=(1, 1, 1), photons=100_000)
    assert far.entered == pytest.approx(4 * math.atan(0.25 / (3 * math.sqrt(9.5))), rel=0.02)


@pytest.mark.parametrize("kind", ["point", "beam"])
@pytest.mark.parametrize("depth", [0.1, 0.3, 1.0, 3.0])
def test_the_lattice_set_up_conserves_energy_at_every_depth(kind, depth):
    light = tracer.fluence(kind, depth, photons=4000)
    assert light.entered == pytest.approx(1.0)
    assert light.exits.sum() + light.absorbed == pytest.approx(1.0, rel=1e-3)
    absorbed = depth * 0.1 * light.fluence.sum()
    assert absorbed == pytest.approx(light.absorbed, rel=0.1)


def test_media_of_the_scene_are_understood_and_bad_ones_refused(monkeypatch):
    fog = Medium((1.0, 2.0, 3.0), (0.9, 0.8, 0.7), (0.0, 0.1, 0.2), ((0, 0, 0), (1, 2, 3)))
    assert (BoxMedium.of_medium(fog, 1).sigma_t, BoxMedium.of_medium(fog, 1).g) == (2.0, 0.1)
    with pytest.raises(ReferenceFailure, match="needs a medium with bounds"):
        BoxMedium.of_medium(Medium((1.0, 1.0, 1.0)))
    with pytest.raises(ReferenceFailure, match=r"'laser' is no light of this set-up\. Use point"):
        tracer.fluence("laser", 1.0)
    with pytest.raises(ReferenceFailure, match="sends no power into the box"):
        trace(BoxMedium(1.0), Beam((0, 0, 1), 0.0))
    monkeypatch.setitem(sys.modules, "airlight.reference.tracer_kernel", None)
    monkeypatch.delattr("airlight.reference.tracer_kernel", raising=False)
    with pytest.raises(ReferenceFailure, match=r"needs Numba. Install it with: pip install"):
        trace(BoxMedium(1.0), Beam((0, 0, 1)))


def test_a_thick_medium_in_equilibrium_glows_as_a_black_body():
    """J = sigma_a B: deep inside radiance is B in all directions, and 4 pi B of fluence."""
    sigma_a, black = 60.0, 2.5
    glow = np.full((3, 3, 3), sigma_a * black, np.float32)
    light = trace(BoxMedium(sigma_a, 0.0), Emitting(glow), cells=(5, 5, 5), photons=200_000)
    middle, error = light.fluence[0, 2, 2, 2], light.fluence_error[0, 2, 2, 2]
    # 2/5 of a metre are 24 optical depths.
    assert middle == pytest.approx(4.0 * math.pi * black, abs=4.0 * error)
    # Each face sends what a black one does, pi B, but for its edges.
    assert light.exits.sum() / 6.0 == pytest.approx(math.pi * black, rel=0.03)


def test_a_clear_medium_sends_all_that_its_voxels_emit():
    glow = np.random.default_rng(3).random((4, 5, 6)).astype(np.float32)
    volume = Volume((0.0,) * 3, np.ones_like(glow), bounds=((0, 0, 0), (2, 1, 3)))
    with pytest.raises(ReferenceFailure, match="emits nothing"):
        Emitting.of_volume(volume)
    lit = Volume(
        (0.0,) * 3,
        np.ones_like(glow),
        bounds=((0, 0, 0), (2, 1, 3)),
        emission=Emission((3.0, 2.0, 1.0), glow),
    )
    light = trace(BoxMedium.of_volume(lit, 1), Emitting.of_volume(lit, 1), photons=20_000)
    power = 4.0 * math.pi * 2.0 * float(glow.mean(dtype=np.float64)) * 6.0
    assert light.entered == pytest.approx(power, rel=1e-9)
    assert light.exits[0].sum() == pytest.approx(power, rel=1e-9)
    with pytest.raises(ReferenceFailure, match="no power"):
        trace(BoxMedium(1.0), Emitting(0.0 * glow))
