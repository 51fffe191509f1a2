"""Surfaces in a medium: no light spreads through them, in its grid or between its cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.delta_beam import MediumGrid, diffusion_of
from airlight.maths.diffusion import solve
from airlight.maths.halved_cells import halved_cells
from airlight.maths.transforms import F64
from airlight.pop.delta.diffuse import Diffuse
from airlight.pop.light.walls import Walls
from airlight.pop.media import PopMedia
from airlight.pop.solver import PopSolver
from airlight.rendering import Renderer, render
from airlight.scene import Camera, Mesh, PointLight, Scene, Volume
from airlight.scene.material import Material
from airlight.scene.shapes import box

SETTINGS = {"ordinates": 4, "grid": 8, "solver_steps": 30, "surfels": 2000, "gather": "off"}
RHO = np.random.default_rng(3).uniform(0.5, 1.0, (8, 8, 8)).astype(np.float32)
SMOKE = Volume((3.0,) * 3, RHO, albedo=(0.9,) * 3)
LIGHT = PointLight((0.8, 0.3, -0.2), (5.0,) * 3)


def block(low: tuple[float, ...], high: tuple[float, ...], albedo: float = 0.5) -> Mesh:
    """A closed box between two corners."""
    matrix = np.diag([*np.subtract(high, low), 1.0])
    matrix[:3, 3] = 0.5 * np.add(low, high)
    return Mesh(box(), Material(base_color=(albedo,) * 3, specular=0.0), matrix)


def scene(*meshes: Mesh, local_light: PointLight = LIGHT, volume: Volume = SMOKE) -> Scene:
    return Scene(
        meshes=meshes,
        lights=(local_light,),
        camera=Camera((-3, 1, 2.5), (0, 0, 0)),
        volumes=(volume,),
    )


@pytest.fixture(scope="module")
def walled() -> tuple[PopSolver, dict[str, F64]]:
    """A wall of .1 m at x = .3, across the whole box; and what the device holds of the solution."""
    wall = block((0.25, -2, -2), (0.35, 2, 2))
    with Renderer(scene(wall), "pop", (16, 16), settings=SETTINGS) as renderer:
        renderer.frame(samples=1)
        (solver,) = renderer.technique.find(PopMedia).solvers
        diffuse, n = solver.transport.diffuse, solver.medium.placement.count
        assert n == (8, 8, 8)
        read = {
            "phi": diffuse.phi.read().reshape(*n, 4),
            "deposits": diffuse.deposits.read().reshape(4, *n, 4),
            "emission": solver.emission.texture.read(),
            "smooth": solver.emission.smooth.texture.read(),
            "density": solver.medium.density.cells.read().reshape(n),
            "walls": diffuse.walls.read(np.uint32).reshape(*n, 2),
        }
    return solver, {name: values.astype(np.float64) for name, values in read.items()}


def test_rays_find_the_wall_and_what_it_reflects(walled):
    """Between the middles at x = .125 and .375, half a cell on; both sides reflect a half."""
    words = walled[1]["walls"].astype(np.uint64)
    upper, lower = (words[..., 0] >> 1) & 1, words[..., 0] & 1
    assert (upper == (np.arange(8) == 4)).all()
    assert (lower == (np.arange(8) == 5)).all()
    assert ((words[..., 0] >> 2) & 15 == 0).all()
    assert np.abs(((words[:, :, 4, 0] >> 8) & 255) / 254 - 0.5).max() < 0.01
    assert ((words[:, :, 4, 1] >> 5) & 31 == 16).all()
    assert (words[:, :, 5, 1] & 31 == 16).all()


def test_light_diffuses_on_one_side_as_its_twin(walled):
    solver, read = walled
    closed = np.zeros((3, 8, 8, 8), bool)
    closed[0, :, :, 4] = True
    at, one = solver.medium.placement, np.ones(3)
    medium = MediumGrid(at.extent, read["density"], RHO, 3.0 * one, 0.9 * one, 0.0 * one)
    width = solver.medium.placed.width.diffusivity
    plain = diffusion_of(medium, width)
    # The wall reflects on both sides; the box ends where there is none.
    reflectance = np.zeros((3, 2, 8, 8, 8))
    reflectance[0, 1, :, :, 4] = reflectance[0, 0, :, :, 5] = 0.5
    system = type(plain)(plain.cell, plain.d, plain.sigma_a, closed, reflectance)
    power, forward = read["deposits"][0, ..., :3], read["deposits"][1:, ..., :3]
    phi, _ = solve(system, system.source(power, forward), SETTINGS["solver_steps"])
    np.testing.assert_allclose(read["phi"][..., :3], phi, rtol=5e-3, atol=2e-3 * phi.max())
    # All of the lamp's light is beyond the wall.
    assert read["phi"][:, :, :5].max() < 1e-6 * phi.max()


def test_surfaces_close_outside_reflect_as_in_the_twin(gpu):
    """A floor a third of a cell under the box reflects a half; one a cell away is not its own."""
    found = {}
    for gap in (0.08, 0.25):
        floor = block((-2, -1.3, -2), (2, -1.0 - gap, 2))
        with Renderer(scene(floor), "pop", (16, 16), settings=SETTINGS) as renderer:
            renderer.frame(samples=1)
            (solver,) = renderer.technique.find(PopMedia).solvers
            diffuse = solver.transport.diffuse
            words = diffuse.walls.read(np.uint32).reshape(8, 8, 8, 2)
            phi = diffuse.phi.read().reshape(8, 8, 8, 4)[..., :3].astype(np.float64)
            deposits = diffuse.deposits.read().reshape(4, 8, 8, 8, 4)[..., :3].astype(np.float64)
            density = solver.medium.density.cells.read().reshape(8, 8, 8).astype(np.float64)
        reflectance = np.zeros((3, 2, 8, 8, 8))
        reflectance[1, 0, :, 0] = 0.5 if gap < 0.1 else 0.0
        lower = (words[..., 1] >> 10) & 31
        np.testing.assert_array_equal(lower, 32 * reflectance[1, 0])
        assert not (words[..., 0] & 63).any()
        at, one = solver.medium.placement, np.ones(3)
        medium = MediumGrid(at.extent, density, RHO, 3.0 * one, 0.9 * one, 0.0 * one)
        plain = diffusion_of(medium, solver.medium.placed.width.diffusivity)
        system = replace(plain, reflectance=reflectance)
        source = system.source(deposits[0], deposits[1:])
        want, _ = solve(system, source, SETTINGS["solver_steps"])
        np.testing.assert_allclose(phi, want, rtol=5e-3, atol=2e-3 * want.max())
        found[gap] = phi[:, 0].mean()
    assert found[0.08] > 1.2 * found[0.25]


def test_light_between_cells_is_of_one_side_as_its_twin(walled):
    read = walled[1]
    walls = np.full((3, 8, 8, 8), np.inf)
    walls[0, :, :, 4] = 0.5
    light = read["emission"][..., :3]
    twin = halved_cells(light, np.ones((8, 8, 8)), walls)
    np.testing.assert_allclose(read["smooth"][..., :3], twin, rtol=2e-3, atol=1e-3 * twin.max())
    assert twin[:, :, :10].max() < 1e-3 * twin[:, :, 10:].min()


def test_walls_follow_what_reaches_into_the_box_and_nothing_else(monkeypatch):
    """A wall at x = .3 that moves, goes and comes; the box that moves; a mesh elsewhere."""
    traced, solved = [], []
    trace, solve = Walls._trace, Diffuse.encode_medium
    monkeypatch.setattr(Walls, "_trace", lambda *given: traced.append(1) or trace(*given))
    monkeypatch.setattr(Diffuse, "encode_medium", lambda *of: solved.append(1) or solve(*of))
    wall, other = block((0.25, -2, -2), (0.35, 2, 2)), block((5, -1, -1), (6, 1, 1))
    other = replace(other, material=replace(other.material, emission=(0.5,) * 3))
    glowing = replace(other, material=replace(other.material, emission=(1.0,) * 3))

    def by(mesh: Mesh, x: float) -> Mesh:
        matrix = mesh.world_from_object.copy()
        matrix[0, 3] += x
        return replace(mesh, world_from_object=matrix)

    stretched = wall.geometry.positions * np.float32([1.0, 0.5, 1.0])
    bent = replace(wall, geometry=replace(wall.geometry, positions=stretched))
    matrix = np.eye(4)
    matrix[0, 3] = 0.5
    aside = replace(SMOKE, world_from_volume=matrix)
    with Renderer(scene(wall, other), "pop", (16, 16), settings=SETTINGS) as renderer:
        for meshes, volume, closed, is_new in (
            ((wall, other), SMOKE, 4, True),
            ((wall, by(other, 1.0)), SMOKE, 4, False),
            ((wall, glowing), SMOKE, 4, False),
            ((by(wall, -0.5), other), SMOKE, 2, True),
            ((by(wall, 9.0), other), SMOKE, None, True),
            ((by(wall, 9.5), other), SMOKE, None, False),
            ((wall, other), SMOKE, 4, True),
            ((bent, other), SMOKE, 4, True),
            ((wall, other), aside, 2, True),
        ):
            traced.clear(), solved.clear()
            renderer.frame(samples=1, meshes=meshes, volumes=(volume,))
            (solver,) = renderer.technique.find(PopMedia).solvers
            words = solver.transport.diffuse.walls.read(np.uint32).reshape(8, 8, 8, 2)
            found = np.flatnonzero(((words[..., 0] >> 1) & 1).any(axis=(0, 1)))
            assert found.tolist() == ([] if closed is None else [closed])
            assert len(traced) == (is_new and closed is not None)
            assert bool(solved) == is_new


def mean_light(scene: Scene) -> float:
    settings = {"surfels": 20000, "gather": "off"}
    image = render(scene, "auto", (24, 18), settings=settings, samples=1)
    return float(image.radiance.mean())


@pytest.mark.parametrize("shape", ["grid", "box"])
def test_a_light_in_a_closed_box_in_smoke_stays_there(shape):
    """Of the open lamp's light .38 came out of it in a grid, .064 in a lattice."""
    volume = SMOKE if shape == "grid" else Volume((3.0,) * 3, shape="box", albedo=(0.9,) * 3)
    local_light = PointLight((0.1, 0.0, 0.05), (5.0,) * 3)
    around = [block((-2, -1.6, -2), (2, -1.5, 2)), block((1.5, -1.5, -2), (1.6, 1.5, 2))]
    held = block((-0.2, -0.3, -0.25), (0.4, 0.3, 0.35))
    lit = mean_light(scene(*around, local_light=local_light, volume=volume))
    held_light = mean_light(scene(*around, held, local_light=local_light, volume=volume))
    assert held_light < 0.01 * lit
