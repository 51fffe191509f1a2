"""Where light with extent comes from: glowing sides of meshes, area lights, balls about points."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..errors import SettingsError
from ..lattice.bodies import outer_side, winding_number
from ..maths.colour import srgb_decode
from ..scene.checks import F64
from ..scene.light_shapes import LightMesh, light_material, unit_geometry
from ..scene.lights import AreaLight, Light, PointLight, SpotLight
from ..scene.lights.area import ball, world_from_unit
from ..scene.material import Texture
from ..scene.mesh import Geometry, Mesh
from ..scene.scene import Scene
from ..scene.texels import nearest
from .touching import Part, parts_of_wholes


@dataclass(frozen=True, eq=False)
class Source:
    """One glowing side of a placed mesh; `side` 1 is the front, -1 the back.

    `is_solid`: the surface is seen, and stands in the way of light. `light`: the scene's light that
    it is the surface of; `mesh` the row of the scene's mesh else. `part`: where it is part of what
    several meshes make together.
    """

    surface: Mesh
    side: int
    mesh: int = -1
    light: int = -1
    spot: SpotLight | None = None
    is_solid: bool = True
    part: Part | None = None


def has_extent(light: Light) -> bool:
    """Whether a light is an area light, or comes from a ball about its point."""
    if isinstance(light, PointLight | SpotLight):
        return light.radius > 0.0
    return isinstance(light, AreaLight)


def sources(scene: Scene) -> list[Source]:
    """All that glows; what the meshes of area lights show is among the lights."""
    # Meshes of area lights come with their lights.
    eye = np.array(scene.camera.position)
    glowing = {
        row: mesh
        for row, mesh in enumerate(scene.meshes)
        if mesh.material.is_emissive and not isinstance(mesh, LightMesh)
    }
    # Meshes that belong together are one light, sampled over the whole.
    parts = parts_of_wholes(glowing)
    found = [
        Source(mesh, side, mesh=row, part=part)
        for row, mesh in glowing.items()
        for part in [parts.get(row)]
        for side in _sides(Mesh(part.whole, mesh.material) if part else mesh, eye)
    ]
    # Area lights are surfaces of their own; points with a radius are balls.
    for row, light in enumerate(scene.lights):
        if isinstance(light, AreaLight) and max(light.radiance) > 0.0:
            sides = (1, -1) if light.two_sided and light.shape != "sphere" else (1,)
            surface = _surface(light)
            found += [Source(surface, side, light=row, is_solid=light.visible) for side in sides]
        elif isinstance(light, PointLight | SpotLight) and light.radius > 0.0:
            surface = _surface(light)
            spot = light if isinstance(light, SpotLight) else None
            found.append(Source(surface, 1, light=row, spot=spot, is_solid=False))
    return found


def _surface(light: AreaLight | PointLight | SpotLight) -> Mesh:
    """What glows of a light: its shape, or the ball about its point."""
    if not isinstance(light, AreaLight):
        light = ball(light.position, light.intensity, light.radius)
    return Mesh(unit_geometry(light.shape), light_material(light), world_from_unit(light))


def _sides(mesh: Mesh, eye: F64) -> tuple[int, ...]:
    """Which sides glow; of a closed body that glows on both: the outer, or that around the eye."""
    # One-sided surfaces glow in front; open sheets on both sides.
    if not mesh.material.two_sided:
        return (1,)
    outer = _outer_side(mesh.geometry)
    if outer == 0:
        return (1, -1)
    low, high = mesh.world_bounds
    is_around = bool(((eye > low) & (eye < high)).all()) and winding_number(mesh, eye) > 0.5
    return (-outer if is_around else outer,)


@lru_cache(maxsize=256)
def _outer_side(geometry: Geometry) -> int:
    return outer_side(snapped(geometry))


def snapped(geometry: Geometry) -> Geometry:
    """The geometry with vertices in one place that rounding alone keeps apart."""
    # Rounded to a grid far below any detail.
    positions = geometry.positions
    unit = max(float(np.ptp(positions, axis=0).max()), 1e-30) * 2.0**-18
    rounded = (np.round(positions / unit) * unit + 0.0).astype(np.float32)
    return replace(geometry, positions=rounded)


def texture_light(texture: Texture, uv: F64) -> F64:
    """Linear RGB (n, 3), 0 to 1, of the texels at `uv` (n, 2)."""
    rgb = nearest(texture, uv)[:, :3].astype(np.float64) / 255.0
    return np.asarray(srgb_decode(rgb) if texture.is_srgb else rgb)


def moved(source: Source, scene: Scene) -> Source:
    """The same source as it stands in `scene`."""
    # The mesh, the area light or the ball of the scene in this frame.
    if source.mesh >= 0:
        return replace(source, surface=scene.meshes[source.mesh])
    light = scene.lights[source.light]
    if isinstance(light, AreaLight):
        return replace(source, surface=_surface(light))
    if isinstance(light, PointLight | SpotLight) and light.radius > 0.0:
        spot = light if isinstance(light, SpotLight) else None
        return replace(source, surface=_surface(light), spot=spot)
    raise SettingsError(
        "frame() got a light without extent where the scene's had one", remedy="Make a new Renderer"
    )
