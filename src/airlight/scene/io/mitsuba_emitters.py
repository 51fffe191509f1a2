"""Mitsuba's emitters as lights, an environment, and emissive surfaces."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import cast

import numpy as np

from ...errors import SceneError, nearest
from ...maths.colour import srgb_decode
from ...maths.latlong import latlong_texel_directions
from ...maths.transforms import triple
from ..checks import F32, F64
from ..environment import Environment
from ..lights import DirectionalLight, Light, PointLight, SpotLight
from ..material import Material
from .images import read_radiance
from .mitsuba_nodes import Node
from .mitsuba_textures import Source, color_input, texture_input

MAX_HALF_ANGLE_DEG = 89.0
_LEFT_OUT = ("projector", "directionalarea", "sunsky", "timed_sunsky", "sky", "sun", "collimated")
_KINDS = ("point", "spot", "directional", "constant", "envmap", "area")


def emitter(node: Node, source: Source) -> Light | Environment | None:
    """The light of an emitter that stands alone; None, and a note, for one that is not read."""
    # Emitters with a place or a direction.
    readers = {"point": _point, "spot": _spot, "directional": _directional}
    if node.kind in readers:
        return readers[node.kind](node, source)
    if node.kind == "constant":
        # Light from all around.
        return Environment(radiance=color_input(node, "radiance", 1.0, source)[0])
    if node.kind == "envmap":
        return _envmap(node, source)
    # What is known and not read is left out with a note, what is unknown refused.
    if node.kind == "area":
        return None  # it stands here for shapes to refer to
    if node.kind in _LEFT_OUT:
        source.note(f"{node} is left out: emitters of this kind are not read")
        node.read.update(node.values)
        return None
    raise SceneError(
        f"{node} is no emitter of Mitsuba's",
        where=source.path,
        remedy=nearest(node.kind, (*_LEFT_OUT, *_KINDS)),
    )


def with_emission(material: Material, node: Node, source: Source) -> Material:
    """`material` emissive as an area emitter is: on its front only."""
    if node.kind != "area":
        source.note(f"{node} on a shape is left out")
        return material
    radiance, texture = color_input(node, "radiance", 1.0, source)
    return replace(material, emission=radiance, emission_texture=texture)


def _point(node: Node, source: Source) -> Light:
    matrix = node.get("to_world")
    # A transform places the light, where there is one; else its position does.
    position = node.get("position") or (0.0, 0.0, 0.0)
    if matrix is not None:
        position = triple(matrix[:3, 3])
    return PointLight(position, color_input(node, "intensity", 1.0, source)[0])


def _directional(node: Node, source: Source) -> Light:
    matrix = node.get("to_world")
    # Mitsuba's light goes along +Z, before its transform.
    direction = node.get("direction") or (0.0, 0.0, 1.0)
    if matrix is not None:
        direction = triple(matrix[:3, :3] @ (0.0, 0.0, 1.0))
    return DirectionalLight(direction, color_input(node, "irradiance", 1.0, source)[0])


def _spot(node: Node, source: Source) -> Light:
    matrix = node.get("to_world")
    matrix = np.eye(4) if matrix is None else matrix
    # The cone, and where inside it the light begins to fall off.
    outer = float(node.get("cutoff_angle", 20.0))
    inner = float(node.get("beam_width", 0.75 * outer))
    texture = node.child("texture")
    ours = re.match(r"airlight_inner_([0-9.]+)", texture.id) if texture else None
    if texture is not None:
        texture.read.update(texture.values)
    if ours:  # what reference/mitsuba_lights.py projects is our own fall-off
        inner = float(ours.group(1))
    mean = np.ones(3)
    if texture is not None and not ours:
        source.note(f"{node}: of the texture it projects the mean is taken, in its circle")
        mean = _mean_in_circle(texture, source)
    # What our cone cannot be.
    if not ours and inner < outer:
        source.note(f"{node}: its fall-off, linear in the angle, is read as our smooth one")
    if outer > MAX_HALF_ANGLE_DEG:
        source.note(f"{node}: its cone is cut to {MAX_HALF_ANGLE_DEG:g} degrees")
        outer = MAX_HALF_ANGLE_DEG
    return SpotLight(
        triple(matrix[:3, 3]),
        triple(matrix[:3, 2]),
        triple(mean * color_input(node, "intensity", 1.0, source)[0]),
        inner_deg=min(inner, outer),
        outer_deg=outer,
    )


def _mean_in_circle(node: Node, source: Source) -> F64:
    """The mean (3,) of what a texture shows in the circle that touches its sides."""
    factor, texture = texture_input(node, source, is_color=True)
    if texture is None:
        return np.array(factor)
    values: F64 = texture.pixels[..., :3] / 255.0
    values = np.asarray(srgb_decode(values)) if texture.is_srgb else values
    height, width = values.shape[:2]
    y, x = np.meshgrid(np.linspace(-1, 1, height), np.linspace(-1, 1, width), indexing="ij")
    inside = x * x + y * y <= 1.0
    mean: F64 = np.array(factor) * values[inside].mean(axis=0)
    return mean


def _envmap(node: Node, source: Source) -> Environment:
    path = source.file(node)
    pixels = read_radiance(path, source.notes)
    # Its turn; a turn about the vertical axis is a number of ours.
    matrix = node.get("to_world")
    turn = np.eye(3) if matrix is None else np.asarray(matrix, dtype=np.float64)[:3, :3]
    # Scales do not turn a map; the sign of a mirror stays in it.
    turn = turn / np.cbrt(abs(np.linalg.det(turn)) or 1.0)
    angle = math.atan2(turn[0, 2], turn[2, 2])
    about_y = np.array(
        [
            [math.cos(angle), 0.0, math.sin(angle)],
            [0.0, 1.0, 0.0],
            [-math.sin(angle), 0.0, math.cos(angle)],
        ]
    )
    # Any other one is put into the map's pixels.
    if not np.allclose(turn, about_y, atol=1e-6):
        source.note(f"{node}: its map is resampled for its turn")
        pixels, angle = _turned_map(pixels, turn), 0.0
    return Environment(
        map=pixels,
        scale=float(node.get("scale", 1.0)),
        rotation_deg=math.degrees(angle),
        source=str(path),
    )


def _turned_map(pixels: F32, turn: F64) -> F32:
    """The latitude-longitude map seen through `turn` (world from map), bilinear."""
    # Backwards: for each texel of the turned map, the direction that it shows, and where the old
    # map has that.
    height, width = pixels.shape[:2]
    world = latlong_texel_directions(height, width)
    x, y, z = np.moveaxis(world @ np.linalg.inv(turn).T, -1, 0)
    # Bilinear: columns go round, rows end at the poles.
    column = np.arctan2(x, -z) / (2 * np.pi) % 1.0 * width - 0.5
    row = np.arccos(np.clip(y, -1, 1)) / np.pi * height - 0.5
    i, j = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    s, t = (column - i)[..., None], (row - j)[..., None]
    low, high = (np.clip(j + k, 0, height - 1) for k in (0, 1))
    left, right = i % width, (i + 1) % width
    above = pixels[low, left] * (1 - s) + pixels[low, right] * s
    below = pixels[high, left] * (1 - s) + pixels[high, right] * s
    return cast(F32, (above * (1 - t) + below * t).astype(np.float32))
