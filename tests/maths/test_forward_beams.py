"""Light that media only scatter forwards: shaders against NumPy, and NumPy against quadrature."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths.forward_beams import BACK, depths, passed_forwards, slant, span_beside

Evaluate = Callable[..., np.ndarray]
RNG = np.random.default_rng(3)


def test_depths_of_several_media_add_up_to_their_extinction():
    sigma_t, albedo = RNG.random((3, 3)) * 2.0, RNG.random((3, 3))
    columns, g = RNG.random((5, 3)), np.array([[0.0] * 3, [0.6] * 3, [0.9, 0.5, 0.0]])
    reduced, forward = depths(columns, sigma_t, albedo, g)
    np.testing.assert_allclose(reduced + forward, columns @ sigma_t)
    # What is absorbed, and sigma_s (1 - g), is left of them.
    np.testing.assert_allclose(reduced, columns @ (sigma_t - sigma_t * albedo * g))
    assert not depths(columns[:, :1], sigma_t[:1], albedo[:1], g[:1])[1].any()


def test_passed_forwards(wgsl: Evaluate) -> None:
    reduced, forward = RNG.random((2, 64, 3)) * 4.0
    truth = np.exp(-reduced) - np.exp(-reduced - forward)
    np.testing.assert_allclose(passed_forwards(reduced, forward), truth)
    found = wgsl("forward_beams", "passed_forwards", reduced, forward, returns="vec3f")
    np.testing.assert_allclose(found[..., :3], truth, atol=1e-6)


def test_slant(wgsl: Evaluate) -> None:
    near, length, g = RNG.random((3, 64)) * [[3.0], [2.0], [0.95]]
    truth = np.stack(slant(near, near + length, g), axis=-1)
    found = wgsl("forward_beams", "slant", near, near + length, g, returns="vec2f")
    np.testing.assert_allclose(found[..., :2], truth, rtol=1e-5)
    # The root mean square of the distance, of a medium that deflects alike all along.
    at = near[:, None] + length[:, None] * (np.arange(200) + 0.5) / 200
    np.testing.assert_allclose(truth[:, 1], np.sqrt((at**2).mean(axis=1)), rtol=0.01)
    assert pytest.approx(1.0 / np.sqrt(3.0), abs=0.003) == BACK


def test_span_beside(wgsl: Evaluate) -> None:
    size = np.array([2.0, 1.0, 3.0])
    origin, towards = RNG.normal(size=(256, 3)) * 2.0, RNG.normal(size=(256, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    truth = span_beside(size, origin, towards)
    sizes = np.broadcast_to(size, origin.shape)
    found = wgsl("forward_beams", "span_beside", sizes, origin, towards, returns="vec3f")[..., :3]
    met = truth[:, 0] < truth[:, 1]
    np.testing.assert_array_equal(met, found[:, 0] < found[:, 1])
    np.testing.assert_allclose(found[met], truth[met], atol=1e-3)
    assert 50 < met.sum() < 250


def test_a_path_beside_a_box_is_taken_for_the_nearest_that_meets_it():
    """Down along y, at x from the middle of a box of two metres, a metre above the point."""
    x = np.array([0.0, 0.5, 1.5, 4.0])
    origin = np.stack([x, 0.0 * x - 2.0, 0.0 * x + 0.1], axis=-1)
    near, far, aside = span_beside((2.0, 2.0, 2.0), origin, np.tile([0.0, 1.0, 0.0], (4, 1))).T
    np.testing.assert_allclose(near, 1.0)
    np.testing.assert_allclose(far, 3.0)
    np.testing.assert_allclose(aside, [0.0, 0.0, 0.7, 3.2])
    # A box behind is none.
    behind = span_beside((2.0, 2.0, 2.0), origin[:1], [[0.0, -1.0, 0.0]])[0]
    assert behind[0] >= behind[1]
