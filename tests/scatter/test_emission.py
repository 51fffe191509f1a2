"""What marching and surfaces read: units, and irradiance on a floor beside a glowing wall."""

import numpy as np
import pytest

from airlight.lattice.placement import Placement
from airlight.maths.lattice6 import surface_irradiance
from airlight.maths.lattice26 import LOOKUP_SCALE, mean_track, scattered_lookup_scale
from airlight.maths.lattice26_walls import returned_sharpness
from airlight.reference.quadrature import polygon_irradiance
from airlight.scatter.emission import Emission
from airlight.scatter.schedule import schedule
from airlight.scatter.state_sum import LatticeKind, StateSum
from airlight.scatter.surface_light import SurfaceLight, SurfaceMedium

PLACEMENT = Placement((0.0, 0.0, 0.0), 0.5, (6, 4, 2))
SHAPE = (3, 2, 4, 6, 4)
SIGMA_T = (0.0, 0.5, 3.0)


def random_cells(seed):
    cells = np.random.default_rng(seed).normal(size=SHAPE) * 0.2
    cells[..., 0] = np.abs(cells[..., 0]) + 0.5
    return cells


def test_mean_radiance_and_direction_of_a_track(gpu, commands, lattice):
    track = random_cells(1)
    track[0, 0, 0, 0] = [-1.0, 0.0, 0.0, 0.0]
    emission = Emission(gpu, PLACEMENT)
    emission.encode(commands, lattice(track), flux=40.0)
    commands.submit()
    unit = emission.mean_scale
    mean = emission.mean.read()[..., :3] * unit
    want = np.maximum(track[..., 0], 0.0) / (4 * np.pi * 0.5**3)
    np.testing.assert_allclose(mean, np.moveaxis(want, 0, -1), rtol=2e-3)
    green = emission.green.read() * unit
    np.testing.assert_allclose(
        green[..., 1:], 3 * track[1, ..., 1:] / (4 * np.pi * 0.5**3), rtol=2e-3, atol=1e-4
    )
    source = emission.source({"lattice_visibility_a": None})
    assert source.direct == 1.0
    assert source.scale == unit


def test_half_floats_never_overflow(gpu, commands, lattice):
    emission = Emission(gpu, PLACEMENT)
    emission.encode(commands, lattice(1e30 * random_cells(2)), flux=1e-30)
    commands.submit()
    assert np.isfinite(emission.red.read()).all()


def test_surfaces_see_less_in_fog_and_more_of_what_comes_from_the_air(gpu, commands, lattice):
    total, forward = random_cells(3), random_cells(4)
    surfaces = SurfaceLight(gpu, PLACEMENT)
    sigma_s = tuple(0.8 * t for t in SIGMA_T)
    surfaces.encode(
        commands,
        lattice(total),
        40.0,
        SurfaceMedium(sigma_s, SIGMA_T),
        forward=lattice(forward),
    )
    commands.submit()
    got = np.stack([t.read() for t in (surfaces.red, surfaces.green, surfaces.blue)])
    share = mean_track(np.array(SIGMA_T), 0.5) / mean_track(0.0, 0.5)
    sides = np.array(PLACEMENT.count) * PLACEMENT.cell
    chord = 4.0 * sides.prod() / (2.0 * sides.prod() * (1.0 / sides).sum())
    scattered = 1.0 - np.exp(-np.array(sigma_s) * chord)
    share *= 1.0 + (scattered_lookup_scale() / LOOKUP_SCALE - 1.0) * scattered
    beams = forward * [1.0, 3.0, 3.0, 3.0] / (LOOKUP_SCALE * PLACEMENT.cell)
    want = total * share.reshape(3, 1, 1, 1, 1) + beams
    np.testing.assert_allclose(got / surfaces.scale, want, rtol=3e-3, atol=3e-3)
    record = surfaces.params().record
    assert record["lookup_scale"] == pytest.approx(LOOKUP_SCALE)
    assert record["power_scale"] == pytest.approx(4 * np.pi * surfaces.scale)


def test_a_floor_beside_a_glowing_wall(gpu, commands, lattice):
    """Measured .16 after 16 steps, .084 after 32 (.122 and .071 in the notes' section 1, without
    the closure that keeps a lit plane from lighting itself)."""
    count = (24, 16, 28)
    wall = np.zeros((3, *count[::-1], 4))
    wall[:, 8:20, 0:12, 0] = np.pi * np.array([1.0, returned_sharpness(), 0.0, 0.0])
    x, z = np.meshgrid(np.arange(16) + 0.5, np.arange(4, 24) + 0.5)
    points = np.stack([x, 0 * x, z], axis=-1)
    normals = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    corners = np.array([[0, 0, 8], [0, 12, 8], [0, 12, 20], [0, 0, 20.0]])
    want = np.abs(polygon_irradiance(points, normals, corners, 1.0))
    for iterations, worst in ((16, 0.18), (32, 0.09)):
        states = StateSum(
            gpu,
            count,
            1.0,
            schedule("none", iterations),
            LatticeKind(has_walls=False, is_varied=False),
        )
        states.set_homogeneous([0.0] * 3, [0.0] * 3)
        total, _ = states.encode(commands, lattice(wall))
        commands.submit()
        state = total.read().reshape(wall.shape)[0, 4:24, 0, :16] / (4 * np.pi)
        got = surface_irradiance(state, normals, 1.0, LOOKUP_SCALE)
        assert np.linalg.norm(got - want) < worst * np.linalg.norm(want)
