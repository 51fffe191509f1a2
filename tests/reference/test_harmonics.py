"""Harmonics are orthonormal, obey the addition theorem, and add up to a peak."""

from __future__ import annotations

import numpy as np

from airlight.reference.harmonics import band_of, harmonics, quadrature_directions, window


def test_they_are_orthonormal_under_their_own_quadrature():
    for bands in (1, 5, 10):
        directions, weights = quadrature_directions(bands)
        np.testing.assert_allclose(weights.sum(), 4.0 * np.pi)
        basis = harmonics(directions, bands)
        gram = (basis * weights[:, None]).T @ basis
        np.testing.assert_allclose(gram, np.eye(bands * bands), atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)


def test_the_addition_theorem():
    """A band's product of two directions is (2 l + 1)/4 pi P_l of their cosine."""
    rng = np.random.default_rng(1)
    d = rng.normal(size=(2, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    product = harmonics(d[0], 8) * harmonics(d[1], 8)
    for band in range(8):
        want = np.polynomial.legendre.legval(d[0] @ d[1], [0] * band + [(2 * band + 1)])
        np.testing.assert_allclose(product[band_of(8) == band].sum() * 4 * np.pi, want, atol=1e-12)


def test_the_window_keeps_the_mean():
    w = window(5)
    assert w[0] == 1.0
    assert (np.diff(w) <= 0.0).all()
