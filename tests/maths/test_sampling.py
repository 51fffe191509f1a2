"""Sequences, hashes, noise and frames: evenness, exact bits, orthonormality."""

import numpy as np
import pytest
from scipy.stats import qmc

from airlight.maths import sampling


def test_fibonacci_sphere_is_even() -> None:
    d = sampling.fibonacci_sphere(500)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0)
    np.testing.assert_allclose(d.mean(axis=0), 0.0, atol=2e-3)
    np.testing.assert_allclose(d.T @ d / 500, np.eye(3) / 3.0, atol=2e-3)
    cosine = d @ d.T - 2.0 * np.eye(500)
    nearest = np.arccos(cosine.max(axis=1))
    assert nearest.min() > 0.75 * np.sqrt(4.0 * np.pi / 500)


def test_r2_has_low_discrepancy_and_can_be_continued() -> None:
    points = sampling.r2_sequence(256)
    assert qmc.discrepancy(points) < 0.1 * qmc.discrepancy(
        np.random.default_rng(1).random((256, 2))
    )
    np.testing.assert_allclose(sampling.r2_sequence(56, start=200), points[200:])


@pytest.mark.parametrize("count", [1, 2, 16, 64])
def test_pixel_jitter_stays_in_the_pixel(count: int) -> None:
    j = sampling.pixel_jitter(count)
    assert j.shape == (count, 2)
    assert np.abs(j).max() < 0.5
    # One point in every row and every column: an edge along pixels is half a step off at most.
    steps = (np.arange(count) + 0.5) / count - 0.5
    for axis in (0, 1):
        np.testing.assert_allclose(np.sort(j[:, axis]), steps, atol=1e-12)


@pytest.mark.parametrize("count", [8, 16, 64])
def test_pixel_jitter_knows_how_much_of_a_pixel_an_edge_covers(count: int) -> None:
    rng = np.random.default_rng(1)
    angle, at = rng.uniform(0, 2 * np.pi, 400), rng.uniform(-0.5, 0.5, 400)
    fine = (np.stack(np.meshgrid(np.arange(64), np.arange(64)), axis=-1).reshape(-1, 2) + 0.5) / 64
    across = np.stack([np.cos(angle), np.sin(angle)])

    def covered(points: np.ndarray) -> np.ndarray:
        return (points @ across > at).mean(axis=0)

    error = np.abs(covered(sampling.pixel_jitter(count)) - covered(fine - 0.5))
    # Points drawn at random are off by a third of a standard deviation of a coin, on average.
    assert error.mean() < 0.35 * 0.5 / np.sqrt(count)


def test_r2_noise_is_uniform_in_space_and_time() -> None:
    x, y = np.meshgrid(np.arange(64), np.arange(64))
    noise = sampling.r2_noise(x, y)
    assert np.abs(np.histogram(noise, 8, (0, 1))[0] / 4096 - 1 / 8).max() < 0.01
    frames = sampling.r2_noise(5, 9, np.arange(16))
    assert np.diff(np.sort(frames)).max() < 0.12


def test_pcg_known_bits() -> None:
    def reference(v: int) -> int:  # arbitrary-precision integers, no NumPy
        state = (v * 747796405 + 2891336453) % 2**32
        word = (((state >> ((state >> 28) + 4)) ^ state) * 277803737) % 2**32
        return (word >> 22) ^ word

    values = [0, 1, 2, 12345, 2**31, 2**32 - 1]
    np.testing.assert_array_equal(sampling.pcg_hash(values), [reference(v) for v in values])
    u = sampling.uniform_from_hash(sampling.pcg_hash(np.arange(100_000)))
    assert abs(u.mean() - 0.5) < 0.004
    assert u.max() < 1.0


def test_frames_are_orthonormal_and_right_handed() -> None:
    n = np.concatenate([sampling.fibonacci_sphere(200), np.eye(3), -np.eye(3)])
    t, b = sampling.orthonormal_frame(n)
    frame = np.stack([t, b, n], axis=1)
    np.testing.assert_allclose(
        frame @ frame.transpose(0, 2, 1), np.tile(np.eye(3), (206, 1, 1)), atol=1e-12
    )
    np.testing.assert_allclose(np.cross(t, b), n, atol=1e-12)
