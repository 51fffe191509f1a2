"""Which fields each recipe yields; a solver of one's own needs nothing but the contract."""

from __future__ import annotations

import ast
import inspect
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from airlight.fields import Fields
from airlight.gpu.commands import Commands
from airlight.lattice.irradiance import Irradiance
from airlight.lattice.lookup import LatticeTextures
from airlight.lighting.kit import Context, Kit, SurfaceSettings
from airlight.lighting.view import View
from airlight.rendering import Renderer
from airlight.scene import Camera, Environment, Material, Mesh, Scene
from airlight.scene.shapes import quad
from airlight.surface.geometry import GpuScene
from airlight.techniques import RECIPES, TECHNIQUES, auto, recipes
from airlight.techniques.technique import Technique

from .conftest import SIZE, SMALL, small_smoke

FIELDS = {
    "direct": set(),
    "single": {"sky_scatter"},
    "lpv": {"irradiance", "lit", "reflected"},
    "lpv-march": {"irradiance", "lit", "reflected", "scattered"},
    "lpv-sum": {"irradiance", "lit", "reflected", "scattered", "sky_scatter"},
    "lpv-scatter": {"air", "irradiance", "lit", "reflected", "scattered", "sky_scatter"},
    "pop": set(),  # its volumes depend on the eye
    "lpv with pop": {"irradiance", "lit", "reflected", "sky_scatter"},
    "lpv-scatter with pop": {"air", "irradiance", "lit", "reflected", "scattered", "sky_scatter"},
}


@pytest.mark.parametrize("name", list(RECIPES))
def test_a_recipe_yields_its_fields(name: str, foggy_box: Scene, smoke_over_floor: Scene) -> None:
    scene = foggy_box
    if "with pop" in name:
        medium = foggy_box.medium if "scatter" in name else None
        scene = replace(small_smoke(smoke_over_floor), medium=medium)
    scene = replace(scene, environment=Environment((0.2, 0.3, 0.4)))
    asked = name if name in TECHNIQUES else "auto"
    settings = {**SMALL, "sky_lights": 4, "sky_resolution": 8}
    if "pop" in name:
        settings |= {"ordinates": 4, "grid": 6, "solver_steps": 4}
    with Renderer(scene, asked, SIZE, settings=settings) as renderer:
        renderer.frame(read=False)
        fields = renderer.technique.fields
        assert renderer.stats()["chosen"] == name
    assert fields is not None
    yielded = {key for key, value in vars(fields).items() if value} - {"sky"}
    assert name in FIELDS, "say in FIELDS which fields the new recipe yields"
    assert yielded == FIELDS[name]


def test_recipes_are_short_enough_to_be_read_as_such() -> None:
    source = ast.parse(inspect.getsource(recipes))
    lines = {
        node.name: (node.end_lineno or 0) - node.lineno + 1
        for node in source.body
        if isinstance(node, ast.FunctionDef)
    }
    made = {recipe.make.__name__ for recipe in RECIPES.values()}
    assert made <= lines.keys()
    assert max(lines[name] for name in made) <= 30
    assert auto.recipe_for(Scene()) == "lpv"


@dataclass
class UniformLight:
    """A solver that a newcomer might write: the same irradiance everywhere, W m^-2."""

    kit: Kit
    irradiance: float
    seen: int = 0

    def solve(self, commands: Commands, frame: Any, fields: Fields) -> Fields:
        place = self.kit.placement
        textures = LatticeTextures(self.kit.gpu, place)
        for texture in (textures.red, textures.green, textures.blue):
            states = np.zeros((*place.count[::-1], 4), np.float32)
            states[..., 0] = self.irradiance
            texture.write(states.astype(np.float32 if "32" in texture.format else np.float16))
        # The lookup divides by the cell's area: then a state of 1 is read as it is.
        rows = [place.params(power_scale=1.0 / place.cell**2, lookup_scale=1.0)]
        table = self.kit.lattices.table.filled(rows)
        return replace(fields, irradiance=Irradiance({"lattices": table, **textures.bound}))

    def solve_view(self, commands: Commands, view: View, fields: Fields) -> Fields:
        self.seen += 1
        return fields

    @property
    def stats(self) -> dict[str, Any]:
        return {"irradiance": self.irradiance}

    def release(self) -> None:
        pass


def test_a_solver_of_ones_own_lights_surfaces(gpu: Any) -> None:
    """Twice the light is twice as bright, and the recipe is three lines."""
    floor = Mesh(quad(), Material(base_color=(0.5,) * 3, specular=0.0), np.diag([4.0, 1, 4.0, 1]))
    scene = Scene(meshes=(floor,), camera=Camera((0.0, 2.0, 0.1), (0.0, 0.0, 0.0)))
    meshes = GpuScene(gpu, scene)
    brightness = []
    for light in (1.0, 2.0):
        settings = SurfaceSettings(resolution=8, sky_lights=0, surfels=100)
        kit = Kit(Context(gpu, scene, meshes, (8, 8)), settings)
        solver = UniformLight(kit, light)
        technique = Technique("uniform", kit, [solver])
        view, commands = View(gpu, (8, 8)), Commands(gpu)
        view.aim(scene.camera)
        technique.solve(commands, scene)
        technique.draw(commands, view)
        commands.submit()
        brightness.append(float(technique.layers(view)["indirect"].read()[4, 4, 0]))
        assert technique.stats["irradiance"] == light
        assert solver.seen == 1
        technique.release()
    assert brightness[0] > 0.0
    assert brightness[1] == pytest.approx(2.0 * brightness[0], rel=1e-3)
