"""Mitsuba's bump maps, which are heights, as normal maps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..checks import F64
from ..material import Material, Texture
from ..mesh import Geometry
from .mitsuba_nodes import Node

_STEEPEST = 99.5
"""Percentile of the slopes that 8 bits reach; steeper ones are as steep."""


def normals_of_heights(heights: Texture) -> tuple[Texture, float]:
    """The normal map of an image of heights 0 to 1, and its `normal_scale` where a unit of the
    texture coordinates is a metre long."""
    height, width = heights.pixels.shape[:2]
    values = heights.pixels[..., 0] / 255.0
    # Slopes along the image's sides: what lies beyond follows as the image repeats.
    right = (np.roll(values, -1, 1) - np.roll(values, 1, 1)) * (0.5 * width * heights.scale[0])
    down = (np.roll(values, -1, 0) - np.roll(values, 1, 0)) * (0.5 * height * heights.scale[1])
    steepest = float(np.percentile(np.maximum(np.abs(right), np.abs(down)), _STEEPEST))
    steepest = steepest or float(np.abs(np.stack([right, down])).max()) or 1.0
    # A normal leans down the slope; v goes up where rows go down.
    leaning = np.stack([-right, down, np.full(values.shape, steepest)], axis=-1) / steepest
    leaning[..., :2] = np.clip(leaning[..., :2], -1.0, 1.0)
    normals = leaning / np.linalg.norm(leaning, axis=-1, keepdims=True)
    rgb = np.round(127.5 * (normals + 1.0)).astype(np.uint8)
    opaque = np.full((height, width, 1), 255, np.uint8)
    pixels = np.concatenate([rgb, opaque], axis=-1)
    return replace(heights, pixels=pixels, is_srgb=False), steepest


def has_bumps(shape: Node) -> bool:
    """Whether a shape's BSDF is a bump map, or holds one that is seen."""
    node = shape.first("bsdf")
    while node is not None:
        if node.kind == "bumpmap":
            return True
        node = node.first("bsdf")
    return False


def on_mesh(material: Material, geometry: Geometry, world_from_object: F64) -> Material:
    """The material of a bump map on a mesh: heights are metres, whatever its coordinates are."""
    if geometry.uvs is None or material.normal_texture is None:
        return material
    corners = geometry.positions.astype(np.float64) @ world_from_object[:3, :3].T
    a, b, c = np.moveaxis(corners[geometry.indices], 1, 0)
    u, v, w = np.moveaxis(geometry.uvs.astype(np.float64)[geometry.indices], 1, 0)
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    (x1, y1), (x2, y2) = (v - u).T, (w - u).T
    covered = float(np.abs(x1 * y2 - y1 * x2).sum())
    if not (area > 0.0 and covered > 0.0):
        return material
    # As long as a unit of the coordinates is on the average of the surface.
    return replace(material, normal_scale=material.normal_scale / np.sqrt(area / covered))
