"""Visibility of slices against the hemisphere's integral; WGSL against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.lattice6 import surface_irradiance
from airlight.maths.occlusion import (
    hidden_flux,
    interreflected,
    replaced,
    specular_visibility,
    visible_arc,
)

RNG = np.random.default_rng(4)


def test_slices_add_up_to_the_cosine_weighted_hemisphere():
    """A normal tilted off the view by 0.7 rad; horizons at every slice's own lowest: all open."""
    tilt = 0.7
    phi = (np.arange(2000) + 0.5) / 2000 * np.pi
    along, axis = np.sin(tilt) * np.cos(phi), np.sin(tilt) * np.sin(phi)
    size = np.sqrt(1.0 - axis**2)
    gamma = np.sign(along) * np.arccos(np.cos(tilt) / size)
    visibility = visible_arc(gamma + np.pi / 2, gamma) + visible_arc(gamma - np.pi / 2, gamma)
    np.testing.assert_allclose(visibility, np.cos(gamma) + gamma * np.sin(gamma), atol=1e-12)
    assert (size * visibility).mean() == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("half_angle", [0.2, 0.8, 1.3])
def test_a_cone_of_sky_overhead_counts_its_sine_squared(half_angle):
    visibility = visible_arc(half_angle, 0.0) + visible_arc(-half_angle, 0.0)
    assert visibility == pytest.approx(np.sin(half_angle) ** 2, rel=1e-12)


def test_white_occluders_hide_little_and_black_ones_all():
    v = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(interreflected(v, 0.0), v, atol=0.05)
    assert (interreflected(v, 0.9)[1:-1] > v[1:-1] + 0.03).all()
    assert (np.diff(interreflected(v, 0.5)) > 0.0).all()
    np.testing.assert_allclose(interreflected(1.0, v), 1.0, atol=0.02)


def test_specular_visibility_ends_at_nothing_and_all():
    n_v, roughness = RNG.random(100), RNG.random(100)
    np.testing.assert_allclose(specular_visibility(1.0, n_v, roughness), 1.0)
    np.testing.assert_allclose(specular_visibility(0.0, n_v * 0.99, 0.0), 0.0, atol=0.3)
    np.testing.assert_allclose(specular_visibility(0.4, 1.0, 1.0), 0.4, atol=0.01)


def test_twins(wgsl):
    h, n = RNG.uniform(0.0, np.pi, (500, 2)), RNG.uniform(-1.5, 1.5, 500)
    facing = np.stack([np.cos(n), np.sin(n)], axis=-1)
    arcs = wgsl("occlusion", "visible_arcs", np.cos(h), facing, returns="vec2f")
    both = np.stack([visible_arc(h[:, 0], n), visible_arc(-h[:, 1], n)], axis=-1)
    np.testing.assert_allclose(arcs, both, atol=1e-4)  # a device's arc cosine
    v, albedo = RNG.random(500), RNG.random((500, 3))
    np.testing.assert_allclose(
        wgsl("occlusion", "interreflected", v, albedo, returns="vec3f"),
        interreflected(v[:, None], albedo),
        atol=1e-5,
    )
    n_v, r = RNG.uniform(0.01, 1.0, 500), RNG.random(500)
    np.testing.assert_allclose(
        wgsl("occlusion", "specular_visibility", v, n_v, r),
        specular_visibility(v, n_v, r),
        atol=1e-5,
    )


def test_what_comes_from_hidden_directions_is_the_integral_over_them():
    """A two-band field, integrated over the half of the hemisphere that near surfaces hide."""
    z = np.sqrt(1.0 - (np.arange(4000) + 0.5) / 4000)
    phi = np.arange(4000) * 2.399963
    directions = np.stack(
        [np.sqrt(1 - z**2) * np.cos(phi), np.sqrt(1 - z**2) * np.sin(phi), z], axis=1
    )
    hidden = directions[:, 0] > 0.0
    state = np.array([2.0, 0.4, -0.3, 0.5])
    exact = ((state[0] - directions @ state[1:]) * hidden).mean()
    found = hidden_flux(state, (directions * hidden[:, None]).mean(axis=0), 1.0 - hidden.mean())
    assert found == pytest.approx(exact, rel=1e-12)


def test_where_all_is_hidden_what_comes_from_there_is_all():
    state = np.array([1.0, 0.2, 0.1, -0.3])
    whole = surface_irradiance(state, [0.0, 0.0, 1.0], 1.0, scale=1.0)
    assert np.pi * hidden_flux(state, [0.0, 0.0, 2.0 / 3.0], 0.0) == pytest.approx(whole, rel=1e-12)
    assert replaced(whole, whole, 0.25) == pytest.approx(0.25 * np.pi)
    assert replaced(1.0, 2.0, 0.0) == 0.0


def test_hidden_light_in_wgsl(wgsl):
    state = RNG.normal(size=(500, 4)) + np.array([2, 0, 0, 0])
    direction = RNG.normal(size=(500, 3)) * 0.3
    v = RNG.random(500)
    np.testing.assert_allclose(
        wgsl("occlusion", "hidden_flux", state, direction, v),
        hidden_flux(state, direction, v),
        atol=1e-5,
    )
    e, known, own = (RNG.random((500, 3)) for _ in range(3))
    np.testing.assert_allclose(
        wgsl("occlusion", "replaced", e, known, own, returns="vec3f"),
        replaced(e, known, own),
        rtol=1e-5,
        atol=1e-6,
    )
