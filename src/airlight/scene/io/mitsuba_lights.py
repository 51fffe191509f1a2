"""Mitsuba's emissive rectangles, disks and spheres as area lights."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np

from ...maths.transforms import triple
from ..lights import AreaLight
from ..lights.area import AREA_SHAPES, AreaShape
from ..material import Material, textures_of
from .mitsuba_nodes import Node
from .mitsuba_shapes import shape_matrix

_SKEW = 1e-4  # of a side: how far axes may be from right angles and from equal lengths


def area_light(node: Node, made: Material) -> AreaLight | None:
    """The light that an emissive shape of the material `made` is.

    None where a light cannot say it: other shapes, images, gloss, skewed placements, balls that
    emit inwards. Those stay surfaces, which light as well.
    """
    # A light reflects and emits alike everywhere, without gloss.
    if node.kind not in AREA_SHAPES or not made.is_emissive or not _is_matte(made):
        return None
    light = _placed(node, made)
    if light is None:
        return None
    # What Mitsuba's file cannot say is in the ids that the writer gave.
    both, unseen = "_two_sided" in _mark(node), "_unseen" in _mark(node)
    return replace(light, reflectance=made.base_color, two_sided=both, visible=not unseen)


def is_back(node: Node) -> bool:
    """Whether a shape is the back of a two-sided light, which its front says already."""
    return "_back" in _mark(node)


def _mark(node: Node) -> str:
    return node.id if node.id.startswith("airlight_light") else ""


def _is_matte(made: Material) -> bool:
    return made.specular == made.metallic == made.alpha_cutoff == 0.0 and not textures_of(made)


def _placed(node: Node, made: Material) -> AreaLight | None:
    matrix = shape_matrix(node)
    x, y, z = matrix[:3, :3].T
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    is_turned = bool(node.get("flip_normals", False))
    # A sphere that stays round.
    if node.kind == "sphere":
        # The ball is round where its axes are of one length and at right angles.
        axes = matrix[:3, :3] / max(float(lengths[0]), 1e-30)
        if is_turned or np.abs(axes.T @ axes - np.eye(3)).max() > _SKEW or lengths[0] == 0.0:
            return None
        centre = np.array(node.get("center", (0.0, 0.0, 0.0)), np.float64)
        radius = float(node.get("radius", 1.0)) * float(lengths[0])
        at = matrix[:3, :3] @ centre + matrix[:3, 3]
        return AreaLight(triple(at), made.emission, "sphere", radius=radius)
    # A rectangle or a disk whose axes stay at right angles.
    # Where the shape's +Z faces, also through a placement that mirrors.
    normal = np.cross(x, y) * (1.0 if x @ np.cross(y, z) >= 0.0 else -1.0)
    if abs(x @ y) > _SKEW * lengths[0] * lengths[1] or not np.linalg.norm(normal) > 0.0:
        return None
    # A disk that becomes an ellipse is no light.
    if node.kind == "disk" and abs(lengths[0] - lengths[1]) > _SKEW * lengths[0]:
        return None
    normal = (-1.0 if is_turned else 1.0) * normal / np.linalg.norm(normal)
    return AreaLight(
        triple(matrix[:3, 3]),
        made.emission,
        cast(AreaShape, node.kind),
        direction=triple(normal),
        up=triple(y / lengths[1]),
        size=(2.0 * float(lengths[0]), 2.0 * float(lengths[1])),
        radius=float(lengths[0]),
    )
