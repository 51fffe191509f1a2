"""Emissive surfaces as light in cells: pi L A a side."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Buffer
from airlight.lattice.blockers import Blockers
from airlight.lattice.emission import InjectEmission, emitted_flux
from airlight.lattice.inject import Resolve, fixed_point_scale, new_sums
from airlight.lattice.lobes import COSINE, InjectionTarget
from airlight.lattice.lookup import texture_scale
from airlight.lattice.placement import Placement
from airlight.scene import Material, Scene
from airlight.surface.geometry import GpuScene

ROOM = Placement((-2.0, -2.0, -2.0), 0.25, (16, 16, 16))
RADIANCE = np.array([3.0, 2.0, 0.5])


@pytest.fixture
def emitted(gpu, commands, owned):
    """emitted(mesh, ...) -> (3, Z, Y, X, 4) W sr^-1."""

    def solve(*meshes):
        scene = Scene(meshes=meshes)
        blockers = owned(Blockers(gpu, scene, owned(GpuScene(gpu, scene)), ROOM, 8000))
        blockers.encode(commands)
        sums, nbytes = owned(new_sums(gpu, ROOM)), 3 * ROOM.cells * 16
        zero, cells = owned(Buffer(gpu, "zero", nbytes)), owned(Buffer(gpu, "cells", nbytes))
        scale = fixed_point_scale(emitted_flux(meshes))
        target = InjectionTarget(ROOM, blockers.walls, sums, scale)
        InjectEmission(gpu).encode(commands, blockers, target, COSINE)
        Resolve(gpu).encode(commands, ROOM, sums, zero, cells, scale)
        commands.submit()
        return cells.read().reshape(3, 16, 16, 16, 4).astype(np.float64)

    return solve


@pytest.mark.parametrize("two_sided", [False, True])
def test_a_panel_gives_pi_l_a_to_each_side_that_shines(emitted, square, two_sided):
    glow = Material(emission=tuple(RADIANCE), two_sided=two_sided)
    panel = square((0, 0.06, 0), (1, 0, 0), (0, 0, -0.5), glow)
    power = 4.0 * np.pi * emitted(panel)[..., 0]
    expected = np.pi * RADIANCE * 2.0
    np.testing.assert_allclose(power[:, :, 8:].sum(axis=(1, 2, 3)), expected, rtol=1e-3)
    below = power[:, :, :8].sum(axis=(1, 2, 3))
    np.testing.assert_allclose(below, expected if two_sided else 0.0, rtol=1e-3)


def test_dark_surfaces_give_nothing(emitted, square):
    assert not emitted(square((0, 0, 0), (1, 0, 0), (0, 0, -1))).any()


def test_the_bound_holds_what_is_emitted(square):
    glow = Material(emission=tuple(RADIANCE))
    panel = square((0, 0, 0), (1, 0, 0), (0, 0, -0.5), glow)
    assert emitted_flux((panel,)) >= 2.0 * np.pi * 3.0 * 2.0 * (1.0 - 1e-9)
    assert emitted_flux((square((0, 0, 0), (1, 0, 0), (0, 0, -1)),)) == 0.0


def test_a_scale_for_no_light_at_all_is_a_float32():
    assert np.isfinite(np.float32(fixed_point_scale(0.0)))
    assert np.isfinite(np.float32(texture_scale(0.0)))
