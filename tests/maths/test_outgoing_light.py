"""Diffuse light towards an eye: its lobes, and its path through the cells."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import outgoing_light as out
from airlight.maths.phase import henyey_greenstein
from airlight.maths.sampling import fibonacci_sphere

G = np.array([0.0, 0.6, 0.9])


@pytest.mark.parametrize("unturned", [0.0, 1.0])
def test_what_leaves_beams_from_everywhere_goes_everywhere(unturned):
    """Beams of no direction leave isotropic light, whatever the phase function."""
    mu = np.linspace(-1.0, 1.0, 5)[:, None]
    lobe = out.leaving_lobe(mu, G, np.zeros(3), unturned)
    np.testing.assert_allclose(lobe, 0.25 / np.pi)


def test_turned_light_keeps_its_power_and_its_mean_cosine():
    mu = fibonacci_sphere(4000)[:, 2:]
    lobe = 4.0 * np.pi * out.leaving_lobe(mu, G, np.ones(3), 0.0)
    np.testing.assert_allclose(lobe.mean(axis=0), 1.0, atol=1e-3)
    np.testing.assert_allclose((lobe * mu).mean(axis=0), out.deposited_anisotropy(G), atol=1e-3)


def test_unturned_light_and_the_peak_are_the_phase_function():
    """Sideways and backwards, where the rest is not clipped, to rounding."""
    mu, f = np.linspace(-1.0, 0.5, 7)[:, None], out.forward_share(G)
    peak = f * henyey_greenstein(mu, (1.0 + 2.0 * G) / 3.0)
    both = (1.0 - f) * out.leaving_lobe(mu, G, np.ones(3), 1.0) + peak
    np.testing.assert_allclose(both, henyey_greenstein(mu, G), rtol=1e-12)


def test_mean_directions_are_those_of_the_beams():
    power, g1 = np.array([[2.0, 2.0], [0.0, 3.0]]), np.array([0.3, -0.2])
    travel = np.array([0.6, 0.0, -0.8])
    forward = 0.7 * power * g1 * travel[:, None, None]
    direction, sharpness = out.first_directions(power, forward, g1)
    np.testing.assert_allclose(sharpness, np.where(power > 0.0, 0.7, 0.0))
    np.testing.assert_allclose(direction[:, 0, 1], travel)
    np.testing.assert_allclose(out.first_directions(power, 0.0 * forward, 0.0 * g1)[1], 0.0)


@pytest.mark.parametrize("towards", [(0.0, 0.0, 1.0), (0.48, -0.64, 0.6)])
def test_light_arrives_through_a_homogeneous_medium_as_the_exponential_says(towards):
    """Source S everywhere in a box: S (1 - exp(-k s)) of the path s from its far side."""
    shape, cell, k = (12, 10, 14), np.array([0.1, 0.12, 0.09]), 3.0
    source, extinction = np.full((*shape, 1), 2.0), np.full((*shape, 1), k)
    eye = np.broadcast_to(np.asarray(towards), (*shape, 3))
    got = out.arriving(source, extinction, eye, cell)[..., 0]
    middle = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1)[..., ::-1] + 0.5
    with np.errstate(divide="ignore", invalid="ignore"):
        far = np.where(eye > 0.0, middle * cell, (np.array(shape[::-1]) - middle) * cell)
        path = np.where(eye == 0.0, np.inf, far / np.abs(eye)).min(axis=-1)
    want = 2.0 * (1.0 - np.exp(-k * path))
    # A path ends within half a step of the border.
    assert np.abs(got - want).max() < 2.0 * (1.0 - np.exp(-0.5 * k * cell.max()))
    assert np.abs(got - want).mean() < 0.06


def test_nothing_arrives_through_what_is_empty_or_black():
    shape = (4, 4, 4, 1)
    eye = np.broadcast_to(np.array([0.0, 0.6, 0.8]), (4, 4, 4, 3))
    black = out.arriving(np.zeros(shape), np.full(shape, 5.0), eye, np.ones(3))
    empty = out.arriving(np.ones(shape), np.zeros(shape), eye, np.ones(3))
    assert black.max() == 0.0 and empty.max() == 0.0


def test_nothing_arrives_from_behind_a_wall():
    """Of a wall across the grid, one side sees its own half as if the other half were not there."""
    shape = (5, 6, 8)
    rng = np.random.default_rng(5)
    source, extinction = rng.random((*shape, 1)), rng.uniform(0.2, 1.0, (*shape, 1))
    eye = np.broadcast_to(np.array([0.6, 0.48, 0.64]), (*shape, 3))
    closed = np.zeros((3, *shape), bool)
    closed[0, :, :, 3] = True
    cell = np.array([0.3, 0.35, 0.4])
    walled = out.arriving(source, extinction, eye, cell, closed)
    for half in (np.s_[:, :, :4], np.s_[:, :, 4:]):
        alone = out.arriving(source[half], extinction[half], eye[half], cell)
        np.testing.assert_allclose(walled[half], alone, rtol=1e-12)
    unwalled = out.arriving(source, extinction, eye, cell)
    assert (walled[:, :, 4:] < unwalled[:, :, 4:] - 1e-3).mean() > 0.2
    np.testing.assert_array_equal(walled[:, :, :4], unwalled[:, :, :4])
