"""Rooms of sheets, and a solver in one of them."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from airlight.fields import Fields, Frame
from airlight.gpu.commands import Commands
from airlight.lattice.nested import nested
from airlight.lighting.kit import Context, Kit, SurfaceSettings
from airlight.scatter.settings import ScatterSettings
from airlight.scatter.solver import ScatterSolver
from airlight.scene.lights import PointLight
from airlight.scene.material import Material
from airlight.scene.medium import Medium
from airlight.scene.mesh import Mesh
from airlight.scene.scene import Scene
from airlight.scene.shapes import quad
from airlight.surface.geometry import GpuScene

LOW, HIGH = np.array([-2.0, -1.0, -1.0]), np.array([2.0, 1.0, 1.0])
FOG = Medium((0.5, 0.5, 0.5), (0.95, 0.95, 0.95))
GREY = Material(base_color=(0.7, 0.7, 0.7))


def sheet(
    axis: int, at: float, low: Any = LOW, high: Any = HIGH, material: Material = GREY
) -> Mesh:
    """The rectangle low..high across `axis` at the coordinate `at`."""
    size, centre = np.subtract(high, low), 0.5 * np.add(low, high)
    matrix = np.eye(4)
    # A unit quad faces +y; its y goes to `axis`, the others after it: a turn, no mirror.
    order = {0: (2, 0, 1), 1: (0, 1, 2), 2: (1, 2, 0)}[axis]
    matrix[:3, :3] = 0.0
    for column, row in enumerate(order):
        matrix[row, column] = size[row] if row != axis else 1.0
    matrix[:3, 3] = centre
    matrix[axis, 3] = at
    return Mesh(quad(), material, matrix)


def room(*more: Mesh, material: Material = GREY) -> tuple[Mesh, ...]:
    """Six closed sheets around LOW..HIGH."""
    sides = [
        sheet(axis, float(end[axis]), material=material) for axis in range(3) for end in (LOW, HIGH)
    ]
    return (*sides, *more)


class Solved:
    """A scene solved once, and what came of it, float64."""

    def __init__(self, gpu: Any, scene: Scene, cells: int = 16, **settings: Any) -> None:
        commands = Commands(gpu)
        surfaces = SurfaceSettings(
            shadow_resolution=128,
            lamp_resolution=128,
            sky_lights=8,
            sky_resolution=32,
            surfels=40_000,
        )
        context = Context(gpu, scene, GpuScene(gpu, scene), (8, 8))
        kit = Kit(context, surfaces, nested(LOW, HIGH, cells + 2))
        # As a technique has it: surfaces that emit are lights.
        scene = kit.emitters.of(scene)
        self.placement = kit.placement
        chosen = dataclasses.replace(ScatterSettings(map_resolution=64), **settings)
        self.solver = ScatterSolver(kit, chosen)
        for _ in range(2):  # the second frame keeps what did not change
            kit.encode(commands, scene, LOW, HIGH)
            self.solver.solve(commands, Frame(scene, LOW, HIGH), Fields(kit.sky_irradiance))
            commands.submit()
        unit = self.solver.emission.mean_scale
        self.mean_radiance = self.solver.emission.mean.read()[..., :3].astype(np.float64) * unit
        shape = (3, *self.placement.count[::-1], 4)
        self.source = self.solver.largest.injection.source.read().reshape(shape).astype(np.float64)


def light_scene(*meshes: Mesh, medium: Medium = FOG, **changes: Any) -> Scene:
    """A lamp left of the middle."""
    light = PointLight((-1.03, 0.07, 0.05), (1.0, 1.0, 1.0))
    return dataclasses.replace(Scene(meshes=meshes, lights=(light,), medium=medium), **changes)
