"""airlight lights and environments as Mitsuba emitters."""

from __future__ import annotations

import math
from typing import assert_never
from xml.etree.ElementTree import Element

import numpy as np

from ..scene.environment import Environment
from ..scene.lights import Light
from ..scene.lights.emitters import Colour, Emitter, ImageFile, LookAt, Point, Value, Vector
from ..scene.lights.point import point_emitter
from ..scene.point_lights import PointLights
from ..scene.scene import Scene
from .mitsuba_emission import is_lit
from .mitsuba_files import FileStore, write_exr
from .mitsuba_xml import (
    add_lookat,
    add_matrix,
    add_number,
    add_rgb,
    add_text,
    add_truth,
    add_xyz,
    plugin,
)


def light_elements(light: Light, files: FileStore, notes: list[str]) -> list[Element]:
    """The emitter of a light without extent, or the shapes that an area light is."""
    return [_element(emitter, files) for emitter in light.emitters(notes)]


def _element(emitter: Emitter, files: FileStore) -> Element:
    """A plugin with its parameters and the plugins inside it."""
    identity = ""
    if emitter.mark:  # ids differ from each other
        identity = f"{emitter.mark}_{len(files.meshes)}"
        files.meshes.append(identity)

    # Plugins inside plugins, as the light describes itself.
    element = plugin(emitter.tag, emitter.kind, emitter.name, id=identity)
    for name, value in emitter.values.items():
        _add(element, name, value, files)
    for inner in emitter.inner:
        element.append(_element(inner, files))
    return element


def _add(element: Element, name: str, value: Value, files: FileStore) -> None:
    match value:
        case bool():
            add_truth(element, name, value)
        case float():
            add_number(element, name, value)
        case str():
            add_text(element, name, value)
        case Point():
            add_xyz(element, "point", name, value.at)
        case Vector():
            add_xyz(element, "vector", name, value.along)
        case Colour():
            add_rgb(element, name, value.rgb)
        case LookAt():
            add_lookat(element, name, value.origin, value.target, value.up)
        case ImageFile():
            pixels = value.pixels
            file = files.once(value.key, value.stem, "exr", lambda path: write_exr(path, pixels()))
            add_text(element, name, file)
        case np.ndarray():
            add_matrix(element, name, value)
        case _:
            assert_never(value)


def has_glow(scene: Scene) -> bool:
    """Whether anything that the eye may see gives light: surfaces, area lights, volumes' balls."""
    if any(mesh.material.is_emissive for mesh in scene.meshes) or any(map(is_lit, scene.volumes)):
        return True
    return any(part.tag == "shape" for light in scene.lights for part in light.emitters([]))


def point_emitters(group: PointLights, files: FileStore) -> list[Element]:
    """One emitter for each light of a group."""
    rows = zip(group.positions.tolist(), group.intensities.tolist(), strict=True)
    return [_element(point_emitter((x, y, z), (r, g, b)), files) for (x, y, z), (r, g, b) in rows]


ROWS_APART = 8
"""Times as many rows of a map with a horizon: Mitsuba blends over one of them."""


def environment_emitter(environment: Environment, files: FileStore) -> Element:
    """A constant or a latitude-longitude map, turned about +Y."""
    if environment.map is None:
        emitter = plugin("emitter", "constant")
        r, g, b = (environment.scale * c for c in environment.radiance)
        add_rgb(emitter, "radiance", (r, g, b))
        return emitter
    # Mitsuba filters across the horizon; more rows narrow the strip where ground and sky mix.
    emitter = plugin("emitter", "envmap")
    pixels = environment.map
    key = ("environment", files.identity(pixels), environment.horizon)
    rows = environment.rows_apart(ROWS_APART)
    name = files.once(key, "environment", "exr", lambda path: write_exr(path, rows))
    add_text(emitter, "filename", name)
    add_number(emitter, "scale", environment.scale)

    # The turn goes about the vertical axis, as a matrix.
    if environment.rotation_deg != 0.0:
        c = math.cos(math.radians(environment.rotation_deg))
        s = math.sin(math.radians(environment.rotation_deg))
        turn = np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]])
        add_matrix(emitter, "to_world", turn)
    return emitter
