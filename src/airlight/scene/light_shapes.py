"""Surfaces of area lights, as meshes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from . import shapes
from .checks import Rgb
from .lights import AreaLight, AreaShape, Light
from .lights.area import world_from_unit
from .material import Material
from .mesh import Geometry, Mesh
from .scene import Scene

_NAME = "area light"
_DISK_SEGMENTS = 48


@dataclass(frozen=True, eq=False)
class LightMesh(Mesh):
    """The mesh of a visible area light, whose light is the light's own."""


@cache
def unit_geometry(shape: AreaShape) -> Geometry:
    """A square of side 1, a disk or a sphere of diameter 1, facing +Y."""
    if shape == "rectangle":
        return shapes.quad()
    return shapes.sphere() if shape == "sphere" else _disk()


def _disk() -> Geometry:
    angle = 2.0 * np.pi * np.arange(_DISK_SEGMENTS) / _DISK_SEGMENTS
    # As large as the disk, not inside of it.
    radius = 0.5 * np.sqrt(angle[1] / np.sin(angle[1]))
    rim = np.stack([radius * np.sin(angle), 0.0 * angle, radius * np.cos(angle)], axis=1)
    # A fan around the middle.
    first = np.arange(1, _DISK_SEGMENTS + 1)
    corners = np.stack([0 * first, first, first % _DISK_SEGMENTS + 1], axis=1)
    positions = np.concatenate([np.zeros((1, 3)), rim])
    return Geometry(
        positions=positions.astype(np.float32),
        indices=corners.astype(np.uint32),
        normals=np.tile(np.array((0.0, 1.0, 0.0), np.float32), (len(positions), 1)),
        uvs=(positions[:, [0, 2]] + 0.5).astype(np.float32),
    )


def light_mesh(light: AreaLight, material: Material | None = None) -> Mesh:
    """The surface of a light; `material`: the one that it has already, else an emissive one."""
    material = material or light_material(light)
    return LightMesh(unit_geometry(light.shape), material, world_from_unit(light), _NAME)


def furnished(scene: Scene) -> Scene:
    """The scene without the surfaces of its lights, if it has more: what lattices are laid over.

    Lights go from place to place; what is laid over where they began would fit them there alone.
    """
    meshes = tuple(mesh for mesh in scene.meshes if not isinstance(mesh, LightMesh))
    is_less = len(meshes) < len(scene.meshes) and bool(meshes or scene.volumes)
    return replace(scene, meshes=meshes) if is_less else scene


def light_material(light: AreaLight) -> Material:
    """Matte, and emissive."""
    return Material(
        name=_NAME,
        base_color=light.reflectance,
        specular=0.0,
        emission=light.radiance,
        two_sided=light.two_sided,
    )


class LightMeshes:
    """Puts the surfaces of visible area lights among a scene's meshes, behind the others.

    A light's material stays the same object as long as its radiance does.
    """

    def __init__(self) -> None:
        self._materials: dict[int, tuple[AreaLight, Material]] = {}
        self._last: tuple[tuple[Light, ...], tuple[Mesh, ...], tuple[Mesh, ...]] | None = None

    def of(self, scene: Scene) -> Scene:
        """The scene with them; the very same where it has no such light."""
        lights = [x for x in scene.lights if isinstance(x, AreaLight) and x.visible]
        if not lights:
            return scene
        # Made again only where lights or meshes changed, as caches want the same objects.
        last = self._last
        if last is None or last[0] != scene.lights or last[1] is not scene.meshes:
            made = tuple(light_mesh(x, self._material(row, x)) for row, x in enumerate(lights))
            last = self._last = (scene.lights, scene.meshes, (*scene.meshes, *made))
        return replace(scene, meshes=last[2])

    def _material(self, row: int, light: AreaLight) -> Material:
        known = self._materials.get(row)
        # Looks alone make a material: a light that only moves keeps its own.
        wanted = _looks(light)
        if known is None or _looks(known[0]) != wanted:
            known = (light, light_material(light))
        self._materials[row] = known
        return known[1]


def _looks(light: AreaLight) -> tuple[Rgb, Rgb, bool]:
    return light.radiance, light.reflectance, light.two_sided
