"""Light that hops on the device against its NumPy twin: parallel grids, shells, the residuum."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import maximum_filter

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths import delta_beam as db
from airlight.maths import ordinate_hops as hop
from airlight.maths.ordinate_grid import grid_density, ordinate_grids, read_back
from airlight.maths.radial_grid import radial_density, radial_grid, read_radial
from airlight.maths.transforms import F64
from airlight.maths.voxels import box_averaged
from airlight.pop.light.illumination import Illumination
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.rendering import Renderer
from airlight.scene import Camera, Mesh, Scene, Volume
from airlight.scene.environment import Environment
from airlight.scene.lights import DirectionalLight, PointLight
from airlight.scene.material import Material
from airlight.scene.shapes import box

from .test_solver import EYE, SKY, SUN, assert_close, blob, of_cells

SETTINGS = {"ordinates": 4, "grid": 8, "solver_steps": 30, "iterations": 6}
LIGHT = PointLight((0.3, 0.4, 0.5), (2.0, 1.0, 0.5))


def solved(gpu: Gpu, scheme: str, lights=(SUN,), sky=SKY, **settings) -> PopSolver:
    made = PopSolver(gpu, blob(), PopSettings(scheme=scheme, **{**SETTINGS, **settings}), lights=1)
    commands = Commands(gpu)
    made.encode(commands, Illumination(lights, sky, EYE))
    commands.submit()
    return made


def air_of(solver: PopSolver) -> db.MediumGrid:
    v, at = solver.medium.volume, solver.medium.placement
    fine = box_averaged(v.density, at.fine_count)
    x, y, z = at.count
    coarse = fine.reshape(z, 2, y, 2, x, 2).mean(axis=(1, 3, 5))
    return db.MediumGrid(at.extent, coarse, fine, *map(np.array, (v.sigma_t, v.albedo, v.g)))


class Twin:
    """One grid of a solver after another, merged."""

    def __init__(self, solver: PopSolver, *, is_paper: bool) -> None:
        self.air, self.is_paper = air_of(solver), is_paper
        self.eye = solver.medium.placement.point(EYE)
        self.iterations = solver.transport.iterations
        shape = (*self.air.density.shape, 3)
        self.merged, self.power = np.zeros(shape), np.zeros(shape)
        self.forward = np.zeros((3, *shape))

    def hop(self, hops, rho, irradiance, cosine, towards):
        light = hop.first_light(hops, self.air, rho, irradiance, is_paper=self.is_paper)
        return hop.propagate(
            hops,
            self.air,
            rho,
            light,
            cosine,
            [towards],
            is_paper=self.is_paper,
            iterations=self.iterations,
        )

    def add_parallel(self, direction: F64, irradiance: F64, cosine: float, cells: int) -> None:
        grids = ordinate_grids(self.air.extent, direction, cells)
        rho = grid_density(grids, 0, self.air.fine, self.air.extent)
        away = self.eye - grids.centres(0)
        mu = away @ direction / np.linalg.norm(away, axis=-1)
        hops = hop.parallel_hops(tuple(grids.count[0]), float(grids.cell[0]))
        light = np.broadcast_to(irradiance, (*rho.shape, 3))
        done = self.hop(hops, rho, light, cosine, mu)
        place = grids.places(0, self.air.centres)
        fill = (self.air.density * np.prod(self.air.cell))[..., None]
        self.merged += read_back(place, rho, done.seen[0])
        safe = np.maximum(rho, 1e-12)[..., None] * hops.volume
        self.power += fill * read_back(place, rho, done.residual / safe)
        carried = fill * read_back(place, rho, done.carried / safe)
        self.forward += carried * np.reshape(direction, (3, 1, 1, 1, 1))

    def add_light(self, position: F64, intensity: F64, side: int) -> None:
        grid = radial_grid(self.air.extent, position, side, side)
        rho = radial_density(grid, self.air.fine, self.air.extent)
        hops = grid.hops(self.air.extent)
        travel = grid.centres() - position
        travel = travel / np.linalg.norm(travel, axis=-1, keepdims=True)
        away = self.eye - grid.centres()
        mu = (travel * away).sum(axis=-1) / np.linalg.norm(away, axis=-1)
        light = intensity / (grid.radii**2)[:, None, None, None] * np.ones((*rho.shape, 1))
        done = self.hop(hops, rho, light, 1.0, mu)
        self.merged += read_radial(grid, grid.places(self.air.centres), rho, done.seen[0])
        top = np.array(self.air.count) - 1
        at = np.clip(grid.centres() / self.air.cell - 0.5, 0.0, top)
        low = np.minimum(at.astype(int), top - 1)
        for k in np.ndindex(2, 2, 2):
            w = np.prod(np.where(np.array(k), at - low, 1.0 - at + low), axis=-1)
            i, j, m = np.moveaxis(low + np.array(k), -1, 0)
            kept = np.where(rho[..., None] > 0.0, done.residual, 0.0)
            np.add.at(self.power, (m, j, i), w[..., None] * kept)


def twin(solver: PopSolver, lights, sky: Environment | None) -> Twin:
    made = Twin(solver, is_paper=solver.settings.scheme == "paper")
    transport, at = solver.transport, solver.medium.placement
    rows = solver._scene_ordinates.of(lights, sky)
    for d, e, c in zip(rows.direction, rows.irradiance, rows.mean_cosine, strict=True):
        made.add_parallel(
            at.direction(d), e / solver.scale, float(c), transport.propagation.grids.capacity
        )
    for local_light in (light for light in lights if isinstance(light, PointLight)):
        position, power = at.point(np.array(local_light.position)), np.array(local_light.intensity)
        made.add_light(position, power / solver.scale, solver.settings.grid)
    return made


def inside(made: Twin) -> np.ndarray:
    return made.air.density[..., None] > 0.0


@pytest.mark.parametrize("scheme", ["split", "paper"])
def test_hops_in_parallel_grids_are_their_twins(gpu, scheme):
    solver = solved(gpu, scheme, residuum=False)
    truth = twin(solver, (SUN,), SKY)
    merged = of_cells(solver, solver.transport.propagation.merge.merged.read(), 1)[0]
    # Devices filter grids with weights of 8 bits, 1/512 off in each of three axes: .8 % on an H100.
    assert_close(merged * inside(truth), truth.merged * inside(truth), 0.01)
    deposits = of_cells(solver, solver.transport.diffuse.deposits.read(), 4)
    assert_close(deposits[0], truth.power, 5e-3)
    if scheme == "split":
        assert_close(deposits[1:], truth.forward, 5e-3)
    else:
        assert np.abs(deposits[1:]).max() == 0.0


def test_hops_around_a_light_are_their_twins(gpu):
    solver = solved(gpu, "split", (LIGHT,), None)
    truth = twin(solver, (LIGHT,), None)
    merged = of_cells(solver, solver.transport.propagation.merge.merged.read(), 1)[0]
    assert_close(merged * inside(truth), truth.merged * inside(truth), 0.01)
    deposits = of_cells(solver, solver.transport.diffuse.deposits.read(), 4)
    assert_close(deposits[0], truth.power, 5e-3)


def test_the_image_is_beams_lobes_and_residuum(gpu):
    solver = solved(gpu, "split", exact_sky=False)
    truth = twin(solver, (SUN,), SKY)
    rows = solver._scene_ordinates.of((SUN,), SKY)
    scale = solver.scale
    each = zip(
        solver.medium.placement.direction(rows.direction),
        rows.irradiance,
        rows.mean_cosine,
        strict=True,
    )
    beams = [db.beam(truth.air, d, e / scale, float(c)) for d, e, c in each]
    away = truth.eye - truth.air.centres
    towards = away / np.linalg.norm(away, axis=-1, keepdims=True)
    phi, flux = hop.residual_light(
        truth.air,
        truth.power,
        truth.forward,
        SETTINGS["solver_steps"],
        solver.medium.placed.width.diffusivity,
    )
    unsolved = db.Solution(truth.air, beams, phi, flux, np.zeros(3), truth.power, truth.forward)
    want = truth.merged + unsolved.beam_emission(towards)[0]
    want = want + hop.residual_emission(truth.air, np.maximum(phi, 0.0), flux, towards)
    got = solver.emission.texture.read()[..., :3].astype(np.float64)
    reached = maximum_filter(truth.air.density, 3, mode="nearest")[..., None] > 0.0
    assert reached.any()
    assert_close(got * inside(truth), want * inside(truth), 0.01)


def test_the_papers_residuum_hops_in_the_mediums_cells(gpu):
    solver = solved(gpu, "paper", residuum_iterations=3)
    assert 1 <= solver.transport.iterations <= 6
    truth = twin(solver, (SUN,), SKY)
    air, cell = truth.air, truth.air.cell
    absorbed = air.density[..., None] * air.sigma_t * (1.0 - air.albedo) * cell.mean()
    light = truth.power / (cell.prod() / cell.mean())
    want = hop.isotropic_hops(light, np.exp(-absorbed), 3)
    got = of_cells(solver, solver.transport.diffuse.diffuse.read(), 7)
    assert_close(got[0], want, 5e-3)


@pytest.mark.parametrize("scheme", ["split", "paper"])
def test_frames_repeat_to_the_bit_and_follow_the_eye(gpu, scheme):
    one = solved(gpu, scheme, (LIGHT,))
    first = one.emission.texture.read()
    assert np.isfinite(first.astype(np.float32)).all()
    assert np.array_equal(first, solved(gpu, scheme, (LIGHT,)).emission.texture.read())
    commands = Commands(gpu)
    one.encode(commands, Illumination((LIGHT,), SKY, -EYE))
    commands.submit()
    assert not np.array_equal(first, one.emission.texture.read())


def test_a_far_light_is_a_parallel_grid(gpu):
    far = PointLight((0.0, 40.0, 0.0), (1600.0,) * 3)
    local_light = solved(gpu, "split", (far,), None).emission.texture.read()[..., :3]
    down = DirectionalLight((0.0, -1.0, 0.0), (1.0,) * 3)
    sun = solved(gpu, "split", (down,), None)
    scale = sun.scale / solved(gpu, "split", (far,), None).scale
    ratio = (
        local_light.astype(np.float64).sum() / sun.emission.texture.read()[..., :3].sum() / scale
    )
    assert ratio == pytest.approx(1.0, abs=0.1)


def test_surfaces_shade_what_hops(gpu):
    """Under a plate that is wider than the medium the sun scatters nothing."""
    found = []
    for height in (1.5, -3.0):
        matrix = np.diag([8.0, 0.1, 8.0, 1.0])
        matrix[1, 3] = height
        scene = Scene(
            meshes=(Mesh(box(), Material(base_color=(0.0,) * 3, specular=0.0), matrix),),
            lights=(DirectionalLight((0, -1, 0), (1, 1, 1)),),
            environment=None,
            camera=Camera((0, 0, 4), (0, 0, 0)),
            volumes=(Volume((1.0,) * 3, shape="box"),),
        )
        settings = {**SETTINGS, "scheme": "split", "resolution": 8, "surfels": 1000}
        with Renderer(scene, "pop", (16, 16), settings=settings) as renderer:
            image = renderer.frame(samples=1)
        found.append(float(image.layers["scattered"].sum()))
    assert found[0] < 0.02 * found[1]


@pytest.mark.parametrize("scheme", ["delta-beam", "hops"])
def test_light_of_the_reduced_medium_takes_memory_where_it_is_known(gpu: Gpu, scheme: str) -> None:
    made = PopSolver(gpu, blob(), PopSettings(scheme=scheme, **SETTINGS), lights=1)
    knows = made.transport.has_mean
    assert made.emission.mean.size == (made.medium.placement.count if knows else (1, 1, 1))
    assert (made.sources(0)[0].mean is not None) == knows
