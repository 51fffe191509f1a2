"""Irradiance off exported cells: closed forms, walls, edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from airlight.exports.light_field import AXES, LatticeLight, LightField
from airlight.exports.lookup import Lookup

SHAPE = (7, 6, 5)  # z, y, x
LOW = np.array([-1.0, 0.0, 2.0])
HIGH = LOW + 0.5 * np.array(SHAPE[::-1])
FADE = np.array([LOW - 0.25, [0.5] * 3, HIGH + 0.25, [0.5] * 3])
UP = np.array([[0.0, 1.0, 0.0]])


def lattice(state, rule="lobe", openness=1.0, walls=0.0):
    """The same state (3, 4), or states (Z, Y, X, 3, 4), in open cells of .5 m from LOW."""
    return LatticeLight(
        origin=tuple(LOW),
        cell=0.5,
        fade=FADE,
        rule=rule,
        surfaces=np.broadcast_to(np.asarray(state, np.float32), (*SHAPE, 3, 4)),
        openness=np.broadcast_to(np.asarray(openness, np.float32), (*SHAPE, 6)),
        walls=np.broadcast_to(np.asarray(walls, np.float32), (*SHAPE, 3)),
    )


def even(red, green, blue):
    state = np.zeros((3, 4))
    state[:, 0] = (red, green, blue)
    return state


def test_even_radiance_lights_every_side_with_pi_times_it():
    held = lattice(even(1.0, 2.0, 4.0))
    points = np.array([[0.2, 1.1, 3.0], [0.5, 2.0, 4.1]])
    normals = np.array([[0.0, 1.0, 0.0], [0.6, 0.0, -0.8]])
    expected = np.tile(np.pi * np.array([1.0, 2.0, 4.0]), (2, 1))
    np.testing.assert_allclose(held.irradiance(points, normals), expected, rtol=1e-6)
    np.testing.assert_allclose(held.ambient_cubes()[3, 2, 1], np.tile(expected[0], (6, 1)))


def test_linear_reading_is_the_cosine_integral_of_two_bands():
    # The integral of (a + b.w) |w.n| over the hemisphere against n is pi (a - 2/3 b.n).
    state = np.array([[1.0, 0.3, -0.6, 0.1]] * 3)
    cubes = lattice(state, "linear").ambient_cubes()[0, 0, 0]
    expected = np.pi * (1.0 - 2.0 / 3.0 * AXES @ state[0, 1:])
    np.testing.assert_allclose(cubes, np.tile(expected[:, None], (1, 3)), rtol=1e-6)


def test_a_lobe_is_nowhere_negative_and_keeps_the_mean():
    state = np.array([[1.0, 0.0, -3.0, 0.0]] * 3)  # all light goes straight down
    cubes = lattice(state).ambient_cubes()[0, 0, 0, :, 0]
    assert (cubes >= 0.0).all()
    assert cubes[2] == cubes.max()
    assert cubes[3] < 0.01 * cubes[2]


def test_light_fades_out_over_half_a_cell_around_the_lattice():
    field = LightField("lpv", "a scene", (lattice(even(1.0, 1.0, 1.0)),))
    points = np.array([[0.2, 1.0, 3.0], [-1.0, 1.0, 3.0], [-1.25, 1.0, 3.0]])
    share = field.irradiance(points, np.repeat(UP, 3, axis=0))[:, 0] / np.pi
    np.testing.assert_allclose(share, [1.0, 0.5, 0.0], atol=1e-6)


def test_a_fine_lattice_fades_into_the_coarser_one():
    fine, coarse = lattice(even(1.0, 1.0, 1.0)), lattice(even(3.0, 3.0, 3.0))
    inner = np.array([LOW + 0.5, [0.5] * 3, HIGH - 0.5, [0.5] * 3])
    field = LightField("lpv", "a scene", (replace(fine, fade=inner), coarse))
    points = np.array([[0.2, 1.5, 3.5], [-0.25, 1.5, 3.5], [-0.5, 1.5, 3.5]])
    share = field.irradiance(points, np.repeat(UP, 3, axis=0))[:, 0] / np.pi
    np.testing.assert_allclose(share, [1.0, 2.0, 3.0], rtol=1e-6)


def test_nothing_is_mixed_in_through_a_closed_face():
    states = np.zeros((*SHAPE, 3, 4))
    states[:, :, 3:, :, 0] = 1.0  # light only beyond x cell 3
    point = np.array([[-1.0 + 0.5 * 2.9, 1.0, 3.0]])
    assert lattice(states).irradiance(point, UP).min() > 0.3
    assert lattice(states, openness=0.0).irradiance(point, UP).max() == 0.0


def test_a_wall_warps_the_lattice_to_the_face_it_was_counted_on():
    states = np.zeros((*SHAPE, 3, 4))
    states[:, :, :2, :, 0] = 1.0  # light before the face between x cells 1 and 2 ...
    walls = np.zeros((*SHAPE, 3))
    walls[:, :, 2, 0] = 0.4  # ... whose wall really stands .4 cells further
    held = lattice(states, walls=walls)
    points = np.array([LOW + 0.5 * np.array([x, 2.5, 2.5]) for x in (2.4, 2.2, 1.4)])
    towards = np.tile([-1.0, 0.0, 0.0], (3, 1))
    np.testing.assert_allclose(held.irradiance(points, towards)[0], np.pi, rtol=1e-6)
    np.testing.assert_allclose(
        Lookup(held).warped(points, towards)[:, 0],
        [2.0, 1.0 + 1.2 / 1.4, 1.0 + 0.4 / 1.4],
        rtol=1e-6,
    )
