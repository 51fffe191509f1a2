"""Draws: instances that share geometry and material, their order, and those in view."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from ..scene.checks import F64
from ..scene.material import Material
from ..scene.material import Texture as SceneTexture
from ..scene.mesh import Mesh, is_mirrored
from .textures import MaterialTextures

MOST_CACHED_VIEWS = 256
"""Whose culling is remembered."""

MAPS = ("base_color", "metallic_roughness", "normal", "emission")


@dataclass(frozen=True)
class Draw:
    """Instances of one geometry with one material."""

    first_index: int
    index_count: int
    base_vertex: int
    first_instance: int
    instance_count: int
    material: Material
    textures: MaterialTextures
    maps: frozenset[str]
    has_map_transform: bool  # whether any of the maps has a scale or an offset
    is_mirrored: bool

    def part(self, first: int, count: int) -> Draw:
        """The same draw, of some of its instances."""
        if (first, count) == (self.first_instance, self.instance_count):
            return self
        return replace(self, first_instance=first, instance_count=count)


@dataclass(frozen=True)
class Visible:
    """The draws that a view sees: all of them, those that light cannot pass, and the others.

    The lists are the same ones as long as nothing moves.
    """

    all: list[Draw]
    solid: list[Draw]
    translucent: list[Draw]

    @classmethod
    def of(cls, draws: list[Draw]) -> Visible:
        """`draws`, told apart."""
        translucent = [draw for draw in draws if draw.material.is_translucent]
        if not translucent:
            return cls(draws, draws, translucent)
        return cls(draws, [d for d in draws if not d.material.is_translucent], translucent)


class Culling:
    """The boxes of all instances, and which draws a view sees; cached until `place`."""

    def __init__(self, draws: list[Draw]) -> None:
        self.draws = draws

        # Instances in a row, each with the number of its draw.
        counts = [d.instance_count for d in draws]
        self._draw_of = np.repeat(np.arange(len(counts)), counts)
        self._visible: dict[bytes, Visible] = {}
        self._whole = Visible.of(draws)

    def place(self, boxes: F64) -> None:
        """The world boxes (N, 2, 3), metres, of the instances in their order."""
        self.low, self.high = boxes[:, 0], boxes[:, 1]
        self._middles, self._halves = boxes.mean(axis=1), 0.5 * (boxes[:, 1] - boxes[:, 0])
        self._visible = {}  # another one: what a second thread is finding is of the boxes before

    def visible(self, clip_from_world: F64) -> Visible:
        """The draws in view: of their instances those that no plane of the clip box excludes.

        The same value is returned for the same view until something moves. The depth planes are not
        tested, because what stands before a light's near plane still casts a shadow.
        """
        # The oldest view makes room.
        key, cached = clip_from_world.tobytes(), self._visible
        found = cached.get(key)
        if found is None:
            if len(cached) >= MOST_CACHED_VIEWS:
                cached.pop(next(iter(list(cached)), b""), None)
            found = cached[key] = self._culled(clip_from_world)
        return found

    def _culled(self, clip_from_world: F64) -> Visible:
        if not self.draws:
            return self._whole

        # Planes of the clip box are sums of the matrix's rows; those of depth are left out.
        x, y, w = clip_from_world[0], clip_from_world[1], clip_from_world[3]
        planes = np.stack([w + x, w - x, w + y, w - y, w])
        # The corner that lies farthest inside a plane decides.
        nearest = self._middles @ planes[:, :3].T + self._halves @ np.abs(planes[:, :3]).T
        is_inside = (nearest + planes[:, 3] >= 0.0).all(axis=1)
        if is_inside.all():
            return self._whole
        # Runs of instances of one draw.
        begins = is_inside & ~(np.roll(is_inside, 1) & (np.roll(self._draw_of, 1) == self._draw_of))
        ends = is_inside & ~(np.roll(is_inside, -1) & (np.roll(self._draw_of, -1) == self._draw_of))
        begins[0], ends[-1] = is_inside[0], is_inside[-1]
        first, last = np.flatnonzero(begins), np.flatnonzero(ends)
        runs = zip(self._draw_of[first].tolist(), first.tolist(), last.tolist(), strict=True)
        return Visible.of([self.draws[d].part(begin, end - begin + 1) for d, begin, end in runs])


def map_of(m: Material, name: str) -> SceneTexture | None:
    """The texture of one of `MAPS`."""
    texture: SceneTexture | None = getattr(m, f"{name}_texture")
    return texture


def draw_order(meshes: tuple[Mesh, ...]) -> list[list[int]]:
    """Mesh indices in runs that share geometry and material.

    Opaque ones come before cut-out ones, and translucent ones last.
    """

    # A material's and a geometry's rank is where the scene names it first.
    first_use: dict[int, int] = {}
    for mesh in meshes:
        for part in (mesh.material, mesh.geometry):
            first_use.setdefault(id(part), len(first_use))

    # What costs most to change comes first: the pipeline, then textures, then geometry.
    def key(index: int) -> tuple[Any, ...]:
        m, g = meshes[index].material, meshes[index].geometry
        maps = tuple(map_of(m, name) is not None for name in MAPS)
        sides = (not m.is_culled, is_mirrored(meshes[index]))
        kinds = (m.is_translucent, m.alpha_cutoff > 0.0)
        return (kinds, sides, maps, first_use[id(m)], first_use[id(g)])

    return [list(run) for _, run in groupby(sorted(range(len(meshes)), key=key), key=key)]
