"""Finer grids inside a medium's: what enters them, what they are for, and what must not show."""

from __future__ import annotations

import dataclasses
import itertools
from typing import Any

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths.diffusion import diffusivity
from airlight.maths.nested_diffusion import entering_fluence, entering_flux
from airlight.maths.transforms import F64
from airlight.maths.voxels import trilinear
from airlight.pop.delta.border import Border
from airlight.pop.light.illumination import Illumination
from airlight.pop.light.importance import Look
from airlight.pop.medium.finer_medium import FinerMedium
from airlight.pop.medium.nesting import finer_cells, placed_ahead
from airlight.pop.medium.placement import placed
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.rendering import Renderer, render
from airlight.scene.camera import Camera
from airlight.scene.environment import Environment
from airlight.scene.lights import DirectionalLight
from airlight.scene.scene import Scene
from airlight.scene.volume import Volume

SUN, SKY = DirectionalLight((0.0, -1.0, 0.0), (3.0, 3.0, 3.0)), Environment((0.2, 0.3, 0.4))
BOX: Any = ((-4.0, -4.0, -4.0), (4.0, 4.0, 4.0))
NESTED = PopSettings(ordinates=6, grid=12, grid_levels=2, exact_sky=False, furnace_correction=0.0)
INSIDE = Camera((0.3, 0.2, 2.0), (0.3, 0.2, -2.0), fov_y_deg=60)


def solved(gpu: Gpu, volume: Volume, settings: PopSettings = NESTED) -> PopSolver:
    """A solver of `volume` under the sun alone, for a camera inside."""
    solver = PopSolver(gpu, volume, settings, lights=1)
    commands = Commands(gpu)
    look = Look(INSIDE, 1.0)
    solver.encode(commands, Illumination((SUN,), None, np.array(INSIDE.position), look=look))
    commands.submit()
    return solver


def centres(solver: PopSolver) -> F64:
    """Centres of cells (z, y, x, 3), m of the world, where its axes are the medium's."""
    at = solver.medium.placement
    axes = [(np.arange(n) + 0.5) * h for n, h in zip(at.count, at.cell, strict=True)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    return np.asarray(np.stack([x, y, z], axis=-1) + at.world_from_medium[:3, 3])


def passed(solver: PopSolver) -> F64:
    """Column densities towards the sun (z, y, x), m."""
    x, y, z = solver.medium.placement.count
    return np.asarray(solver.transport.light.passed.read()[: x * y * z], np.float64).reshape(
        z, y, x
    )


def test_paths_go_on_through_the_whole_medium(gpu):
    solver = solved(gpu, Volume((0.3,) * 3, shape="box", bounds=BOX))
    assert solver.finer is not None
    want = 4.0 - centres(solver.finer)[..., 1]
    np.testing.assert_allclose(passed(solver.finer), want, rtol=2e-3)


def test_what_enters_at_the_border_is_the_twin_s(gpu):
    volume = Volume(
        (0.3, 0.6, 0.9), shape="box", bounds=BOX, albedo=(0.9, 1.0, 0.8), g=(0.0, 0.5, 0.8)
    )
    outer = solved(gpu, volume)
    finer = outer.finer
    assert finer is not None and isinstance(finer.medium, FinerMedium)
    # A larger grid's solution that is nothing but noise, and no light in the finer one.
    rng, x = np.random.default_rng(3), outer.medium.placement.count
    phi, light = (rng.normal(size=(n, x[2], x[1], x[0], 4)) for n in (1, 4))
    outer.transport.diffuse.phi.write(phi.astype(np.float32))
    outer.transport.diffuse.diffuse.write(light.astype(np.float32))
    own, medium = finer.transport.diffuse, finer.medium
    for buffer in (own.deposits, own.diffuse):
        buffer.write(np.zeros(buffer.nbytes // 4, np.float32))
    commands, border = Commands(gpu), Border(medium, medium.mixture, outer.transport.diffuse)
    border.encode_power(commands, medium.params, own.deposits)
    border.encode_flux(commands, medium.params, own.diffuse)
    commands.submit()
    # The twin: power into every cell at a border, and half of what comes in as its net flux.
    n = medium.placement.count
    density = medium.density.cells.read().reshape(n[2], n[1], n[0]).astype(np.float64)
    scattering = np.array(volume.sigma_t) * volume.albedo
    absorbing = volume.sigma_t - scattering
    largest = medium.placed.width.diffusivity
    d = diffusivity(density, scattering * (1.0 - np.array(volume.g)), absorbing, largest)
    power, flux = np.zeros(d.shape), np.zeros((3, *d.shape))
    cell, points = (
        medium.placement.cell,
        centres(finer) - outer.medium.placement.world_from_medium[:3, 3],
    )
    for axis in range(3):
        for side, outwards in ((0, -1.0), (-1, 1.0)):
            face = tuple(side if a == 2 - axis else slice(None) for a in range(3))
            normal = outwards * np.eye(3)[axis]
            at = (points[face] + 0.5 * cell * normal).reshape(-1, 3)
            sent = entering_fluence(
                phi[0, ..., :3],
                np.moveaxis(light[1:, ..., :3], 0, -1),
                outer.medium.placement.cell,
                at,
                normal,
            )
            entered = entering_flux(sent.reshape(d[face].shape), float(cell[axis]), d[face])
            power[face] += entered * np.prod(cell) / cell[axis]
            flux[axis][face] -= 0.5 * outwards * entered
    got = own.deposits.read().reshape(4, *d.shape[:3], 4)[0, ..., :3]
    np.testing.assert_allclose(got, power, atol=2e-4 * np.abs(power).max())
    got = own.diffuse.read().reshape(7, *d.shape[:3], 4)[1:4, ..., :3]
    np.testing.assert_allclose(got, flux, atol=2e-4 * np.abs(flux).max())


def test_a_shadow_s_edge_is_sharper(gpu):
    # A slab over one half of a thin medium: its shadow's edge, a plane, is exact by geometry.
    density = np.full((32, 32, 32), 0.05, np.float32)
    density[:, 24:, :16] = 4.0
    outer = solved(gpu, Volume((1.0,) * 3, density, bounds=BOX))
    points = np.random.default_rng(1).uniform((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), (4000, 3))
    step = np.interp(points[:, 0], [-0.125, 0.125], [4.0, 0.05])  # trilinear between voxels
    want = np.exp(-(0.05 * (2.0 - points[:, 1]) + 2.0 * step))
    errors = []
    for one in (outer, outer.finer):
        assert one is not None
        at = one.medium.placement
        places = (points - at.world_from_medium[:3, 3]) / at.cell
        errors.append(
            float(np.sqrt(np.mean((np.exp(-trilinear(passed(one), places)) - want) ** 2)))
        )
    assert errors[1] < 0.75 * errors[0], errors


def image(camera: Camera, volume: Volume, **settings: int) -> F64:
    scene = Scene(lights=(SUN,), environment=SKY, volumes=(volume,), camera=camera)
    settings = {"ordinates": 16, **settings}
    return render(scene, "pop", (64, 36), settings=settings, samples=1).radiance.astype(np.float64)


@pytest.mark.parametrize(
    ("camera", "grid"), [(INSIDE, 24), (Camera((0.0, 0.0, 12.0), (0.0, 0.0, 0.0)), 12)]
)
def test_a_homogeneous_medium_looks_the_same(camera, grid):
    # From outside as on one grid (measured: 2e-5); from inside as on one of the finer cells (.0044:
    # what enters a finer grid does so evenly), which is 1.2 % from the coarser one's image.
    volume = Volume((0.4,) * 3, shape="box", bounds=BOX, albedo=(0.9,) * 3, g=(0.5,) * 3)
    one, two = image(camera, volume, grid=grid), image(camera, volume, grid=12, grid_levels=2)
    assert two.mean() == pytest.approx(one.mean(), rel=0.006)
    assert np.sqrt(((two - one) ** 2).mean()) < 0.02 * one.mean()


def test_nothing_jumps_while_the_camera_moves():
    rng = np.random.default_rng(2)
    density = rng.random((16, 16, 16)).astype(np.float32)
    volume = Volume((0.6,) * 3, density, bounds=BOX, albedo=(0.95,) * 3, g=(0.5,) * 3)
    scene = Scene(lights=(SUN,), environment=SKY, volumes=(volume,), camera=INSIDE)
    settings = {"grid": 12, "ordinates": 8, "grid_levels": 2}
    with Renderer(scene, "pop", (32, 18), settings=settings) as renderer:
        frames = []
        for x in np.linspace(0.0, 0.7, 15):  # two cells of the finer grid, a seventh at a time
            moved = dataclasses.replace(
                INSIDE, position=(0.3 + x, 0.2, 2.0), target=(0.3 + x, 0.2, -2.0)
            )
            shown = renderer.frame(camera=moved)
            assert shown is not None
            frames.append(shown.radiance.astype(np.float64))
    changes = [np.sqrt(((b - a) ** 2).mean()) / a.mean() for a, b in itertools.pairwise(frames)]
    assert max(changes) < 2.0 * float(np.median(changes)), changes


def test_grids_move_in_whole_cells_inside_the_medium():
    whole = placed(Volume((1.0,) * 3, shape="box", bounds=((0.0, 0.0, 0.0), (10.0, 5.0, 8.0))), 16)
    cells = finer_cells(whole, 1, 2.0)
    assert cells.cell == pytest.approx(0.5 * whole.cell.min())
    grid, look = None, np.array([1.0, 0.2, -0.3])
    for eye in np.random.default_rng(0).uniform(-5.0, 15.0, (50, 3)):
        grid = placed_ahead(whole, cells, eye, look, grid)
        steps = grid.offset / cells.cell
        np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
        low, high = grid.offset, grid.offset + grid.placement.extent
        assert (low >= -3.0 * cells.cell).all()
        assert (high <= whole.extent + 3.0 * cells.cell).all()
    # An eye that trembles moves nothing.
    assert placed_ahead(whole, cells, eye + 0.1 * cells.cell, look, grid).offset == pytest.approx(
        grid.offset
    )


@pytest.mark.parametrize(
    ("settings", "message"),
    [({"scheme": "split"}, "is for scheme = 'delta-beam'"), ({}, "for a medium that is alone")],
)
def test_what_has_no_nested_grids_says_so(settings, message):
    ball = Volume((1.0,) * 3, shape="sphere", bounds=BOX)
    count = 1 if settings else 2
    scene = Scene(lights=(SUN,), volumes=(ball,) * count, camera=INSIDE)
    with pytest.raises(SettingsError, match=message):
        render(scene, "pop", (16, 9), settings={"grid_levels": 2, **settings}, samples=1)
