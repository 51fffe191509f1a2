"""Two-band intensities: the cosine lobe is a projection and keeps its power."""

import numpy as np

from airlight.maths import sh

MU, MU_WEIGHT = np.polynomial.legendre.leggauss(16)
PHI = np.arange(32) * (2.0 * np.pi / 32)


def sphere_rule() -> tuple[np.ndarray, np.ndarray]:
    """Directions (512, 3) and weights, exact for polynomials up to degree 31."""
    mu, phi = np.meshgrid(MU, PHI, indexing="ij")
    s = np.sqrt(1.0 - mu * mu)
    directions = np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1).reshape(-1, 3)
    return directions, np.repeat(MU_WEIGHT * 2.0 * np.pi / 32, 32)


def test_cosine_lobe_is_the_two_band_projection() -> None:
    # The lobe is 3/pi mu over the half sphere about its normal, +z; mu integrates in halves.
    mu, weight = 0.5 * (MU + 1.0), 0.5 * MU_WEIGHT
    power = 3.0 / np.pi * mu * weight * 2.0 * np.pi
    # Orthogonal to 1 and w on the sphere: a is the mean, b three times the mean of w.
    a, along = power.sum() / (4.0 * np.pi), 3.0 * (power * mu).sum() / (4.0 * np.pi)
    np.testing.assert_allclose(sh.cosine_lobe([0.0, 0.0, 1.0], 3.0), [a, 0.0, 0.0, along])


def test_cosine_lobe_keeps_its_power() -> None:
    d, w = sphere_rule()
    lobe = sh.cosine_lobe(np.array([0.48, -0.6, 0.64]), 3.0)
    np.testing.assert_allclose(sh.intensity(lobe, d) @ w, 3.0)
