"""Spherical harmonics: orthonormality, the cosine lobe, intensities, environment maps."""

import numpy as np
import pytest

from airlight.maths import sh

MU, MU_WEIGHT = np.polynomial.legendre.leggauss(16)
PHI = np.arange(32) * (2.0 * np.pi / 32)


def sphere_rule() -> tuple[np.ndarray, np.ndarray]:
    """Directions (512, 3) and weights, exact for polynomials up to degree 31."""
    mu, phi = np.meshgrid(MU, PHI, indexing="ij")
    s = np.sqrt(1.0 - mu * mu)
    directions = np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1).reshape(-1, 3)
    return directions, np.repeat(MU_WEIGHT * 2.0 * np.pi / 32, 32)


def test_basis_is_orthonormal() -> None:
    d, w = sphere_rule()
    y = sh.sh_basis(d)
    np.testing.assert_allclose(np.einsum("ni,nj,n->ij", y, y, w), np.eye(9), atol=1e-13)


def test_clamped_cosine_constants_of_the_notes() -> None:
    c = sh.clamped_cosine_sh([0.0, 0.0, 1.0])
    np.testing.assert_allclose(c[[0, 2]], [0.8862269255, 1.0233267079], atol=1e-10)


def test_clamped_cosine_is_the_projection() -> None:
    # In the frame of its normal only the zonal coefficients survive; mu integrates in halves.
    mu = 0.5 * (MU + 1.0)
    d = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=-1)
    zonal = np.einsum("n,nk->k", 0.5 * MU_WEIGHT * 2.0 * np.pi * mu, sh.sh_basis(d))[[0, 2, 6]]
    np.testing.assert_allclose(sh.clamped_cosine_sh([0.0, 0.0, 1.0])[[0, 2, 6]], zonal, atol=1e-12)


def test_cosine_lobe_is_the_two_band_projection_and_keeps_its_power() -> None:
    n = np.array([0.48, -0.6, 0.64])
    lobe = sh.cosine_lobe(n, 3.0)
    np.testing.assert_allclose(
        sh.sh_from_intensity(lobe), 3.0 / np.pi * sh.clamped_cosine_sh(n)[:4]
    )
    d, w = sphere_rule()
    np.testing.assert_allclose(sh.intensity(lobe, d) @ w, 3.0)


def test_intensity_and_coefficients_are_two_names_of_one_function() -> None:
    c = np.random.default_rng(5).normal(size=(4,))
    d, _ = sphere_rule()
    np.testing.assert_allclose(sh.intensity(sh.intensity_from_sh(c), d), sh.sh_evaluate(c, d))
    np.testing.assert_allclose(sh.sh_from_intensity(sh.intensity_from_sh(c)), c)


def test_irradiance_under_a_uniform_sky_is_pi() -> None:
    c = sh.environment_sh(np.ones((7, 13, 3)))
    n = [[0.0, 1.0, 0.0], [0.6, 0.0, -0.8]]
    np.testing.assert_allclose(sh.irradiance_from_radiance_sh(c, n), np.pi, rtol=1e-12)


@pytest.mark.parametrize("shape", [(1, 1), (2, 4), (64, 128)])
def test_constant_maps_have_no_higher_bands(shape: tuple[int, int]) -> None:
    c = sh.environment_sh(np.full((*shape, 1), 2.0))
    np.testing.assert_allclose(c[:, 0], [2.0 / sh.Y0, *[0.0] * 8], atol=1e-12)


def latlong_directions(height: int, width: int) -> np.ndarray:
    theta = (np.arange(height) + 0.5)[:, None] / height * np.pi
    phi = (np.arange(width) + 0.5)[None, :] / width * 2.0 * np.pi
    # u = atan2(x, -z)/2pi, v = acos(y)/pi
    return np.stack(
        [np.sin(theta) * np.sin(phi), np.cos(theta) + 0 * phi, -np.sin(theta) * np.cos(phi)], -1
    )


def test_environment_returns_the_function_it_was_made_of() -> None:
    c = np.random.default_rng(6).normal(size=(9, 3))
    texels = sh.sh_evaluate(c, latlong_directions(256, 512))
    np.testing.assert_allclose(sh.environment_sh(texels), c, atol=2e-4)


@pytest.mark.parametrize("turn_deg", [90.0, -37.0])
def test_environment_rotation_is_counter_clockwise_from_above(turn_deg: float) -> None:
    d = latlong_directions(128, 256)
    a = np.deg2rad(turn_deg)
    # what was at -Z moves towards -X for a positive turn about +Y
    turned = np.array([-np.sin(a), 0.0, -np.cos(a)])
    plain = np.maximum(d @ np.array([0.0, 0.0, -1.0]), 0.0)[..., None]
    direct = np.maximum(d @ turned, 0.0)[..., None]
    np.testing.assert_allclose(
        sh.environment_sh(plain, turn_deg), sh.environment_sh(direct), atol=2e-3
    )
