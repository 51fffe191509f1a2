"""airlight lights and environments as Mitsuba emitters."""

from __future__ import annotations

import math
from typing import assert_never
from xml.etree.ElementTree import Element

import numpy as np

from ..scene.checks import F32, Vec3
from ..scene.environment import Environment
from ..scene.light_shapes import world_from_unit
from ..scene.lights import AreaLight, DirectionalLight, Light, LightSample, PointLight, SpotLight
from ..scene.point_lights import PointLights
from ..scene.scene import Scene
from .mitsuba_files import FileStore, write_exr
from .mitsuba_xml import (
    add_lookat,
    add_matrix,
    add_number,
    add_point,
    add_rgb,
    add_text,
    add_truth,
    add_vector,
    plugin,
)

SPOT_PX = 1024


def light_elements(light: Light, files: FileStore, notes: list[str]) -> list[Element]:
    """The emitter of a light without extent, or the shapes that an area light is."""
    if isinstance(light, DirectionalLight):
        emitter = plugin("emitter", "directional")
        add_vector(emitter, "direction", light.direction)
        add_rgb(emitter, "irradiance", light.irradiance)
        return [emitter]
    if isinstance(light, PointLight):
        if light.radius == 0.0:
            return [_point(light.position, light.intensity)]
        r, g, b = (c / (math.pi * light.radius**2) for c in light.intensity)
        ball = AreaLight(light.position, (r, g, b), "sphere", radius=light.radius, visible=False)
        return _area(ball, notes)
    if isinstance(light, AreaLight):
        return _area(light, notes)
    if isinstance(light, SpotLight):
        if light.radius > 0.0:
            notes.append("a spot light's radius: Mitsuba's spots are points, its shadows are hard")
        return [_spot(light, files)]
    assert not isinstance(light, LightSample), "the device's own"
    assert_never(light)


def _area(light: AreaLight, notes: list[str]) -> list[Element]:
    """A black shape with an area emitter; the back of a two-sided one is a shape of its own."""
    if not light.visible:
        notes.append("a light that is not seen: Mitsuba shows it, and it casts shadows")
    sides = (1.0, -1.0) if light.two_sided and light.shape != "sphere" else (1.0,)
    return [_area_side(light, side) for side in sides]


def _area_side(light: AreaLight, side: float) -> Element:
    shape = plugin("shape", light.shape)
    if light.shape == "sphere":
        add_point(shape, "center", light.position)
        add_number(shape, "radius", light.radius)
    else:
        # Mitsuba's are 2 m across and face +z; ours are 1 m across and face +y.
        unit = world_from_unit(light)
        placed = np.eye(4)
        placed[:3, 0], placed[:3, 1] = 0.5 * side * unit[:3, 2], 0.5 * unit[:3, 0]
        placed[:3, 2], placed[:3, 3] = side * unit[:3, 1], unit[:3, 3]
        # The back lies a hair behind the front.
        placed[:3, 3] += min(side, 0.0) * 1e-5 * max(light.size) * unit[:3, 1]
        add_matrix(shape, "to_world", placed)
    emitter = plugin("emitter", "area")
    add_rgb(emitter, "radiance", light.radiance)
    shape.append(emitter)
    bsdf = plugin("bsdf", "diffuse")
    add_rgb(bsdf, "reflectance", (0.0, 0.0, 0.0))
    shape.append(bsdf)
    return shape


def has_glow(scene: Scene) -> bool:
    """Whether anything that the eye may see gives light: surfaces, area lights, balls."""
    if any(mesh.material.is_emissive for mesh in scene.meshes):
        return True
    return any(
        isinstance(light, AreaLight) or (isinstance(light, PointLight) and light.radius > 0.0)
        for light in scene.lights
    )


def point_emitters(group: PointLights) -> list[Element]:
    """One emitter for each light of a group."""
    rows = zip(group.positions.tolist(), group.intensities.tolist(), strict=True)
    return [_point((x, y, z), (r, g, b)) for (x, y, z), (r, g, b) in rows]


def _point(position: Vec3, intensity: Vec3) -> Element:
    emitter = plugin("emitter", "point")
    add_point(emitter, "position", position)
    add_rgb(emitter, "intensity", intensity)
    return emitter


def _spot(light: SpotLight, files: FileStore) -> Element:
    """A hard cone that projects our fall-off: Mitsuba's own is linear in the angle.

    The image is within 0.5% of the peak at any pair of angles (tested).
    """
    emitter = plugin("emitter", "spot")
    d = np.array(light.direction)
    x, y, z = (float(v) for v in np.array(light.position) + d)
    up: Vec3 = (0.0, 0.0, 1.0) if abs(light.direction[1]) > 0.9 else (0.0, 1.0, 0.0)
    add_lookat(emitter, "to_world", light.position, (x, y, z), up)
    add_rgb(emitter, "intensity", light.intensity)
    add_number(emitter, "cutoff_angle", light.outer_deg)
    add_number(emitter, "beam_width", light.outer_deg)
    if light.inner_deg == light.outer_deg:
        return emitter
    pixels = spot_falloff_pixels(light.inner_deg, light.outer_deg)
    key = ("spot", light.inner_deg, light.outer_deg)
    # The id tells scene/io/mitsuba_emitters.py the inner angle again.
    identity = f"airlight_inner_{light.inner_deg:.9g}_{len(files.meshes)}"
    files.meshes.append(identity)
    texture = plugin("texture", "bitmap", "texture", id=identity)
    name = files.once(key, "spot", "exr", lambda path: write_exr(path, pixels))
    add_text(texture, "filename", name)
    add_truth(texture, "raw", True)
    add_text(texture, "wrap_mode", "clamp")
    emitter.append(texture)
    return emitter


def spot_falloff(cosine: F32, inner_deg: float, outer_deg: float) -> F32:
    """The smoothstep of the cosine between the outer and the inner half angle, in [0, 1]."""
    inner, outer = math.cos(math.radians(inner_deg)), math.cos(math.radians(outer_deg))
    t = np.clip((cosine - outer) / max(inner - outer, 1e-9), 0.0, 1.0)
    falloff: F32 = t * t * (3.0 - 2.0 * t)
    return falloff


def spot_falloff_pixels(inner_deg: float, outer_deg: float) -> F32:
    """The fall-off on the plane that Mitsuba projects: (S, S, 3), tan(outer) at the border."""
    at = ((np.arange(SPOT_PX) + 0.5) / SPOT_PX * 2.0 - 1.0) * math.tan(math.radians(outer_deg))
    cosine = 1.0 / np.sqrt(1.0 + at[:, None] ** 2 + at[None, :] ** 2)
    falloff = spot_falloff(cosine.astype(np.float32), inner_deg, outer_deg)
    return np.repeat(falloff[..., None], 3, axis=2)


def environment_emitter(environment: Environment, files: FileStore) -> Element:
    """A constant or a latitude-longitude map, turned about +Y."""
    if environment.map is None:
        emitter = plugin("emitter", "constant")
        r, g, b = (environment.scale * c for c in environment.radiance)
        add_rgb(emitter, "radiance", (r, g, b))
        return emitter
    emitter = plugin("emitter", "envmap")
    pixels = environment.map
    key = ("environment", files.identity(pixels))
    name = files.once(key, "environment", "exr", lambda path: write_exr(path, pixels))
    add_text(emitter, "filename", name)
    add_number(emitter, "scale", environment.scale)
    if environment.rotation_deg != 0.0:
        c = math.cos(math.radians(environment.rotation_deg))
        s = math.sin(math.radians(environment.rotation_deg))
        turn = np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]])
        add_matrix(emitter, "to_world", turn)
    return emitter
