"""Images of a glTF material that lie by different texture coordinates, brought to one set.

Several TEXCOORD sets, or one that KHR_texture_transform turns by several angles. Of the
coordinates that the material has, those are kept in which no two places of the surface meet for
an image that is drawn again; where all have such places, its charts are laid out again, side by
side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...maths.arrays import F32, F64, I64
from ..material import Material
from .gltf_uv import ImageUse, UvFrame, scale_in
from .texture_bake import MOST_SIDE, Baked, Charts, baked

SMALL_CONFLICT = 0.002
"""The share of an image that may be claimed twice: edges that cross by a texel."""
_GAP = 1.0 / 64.0  # between charts, of the side of all: over two texels of the smallest image


@dataclass(frozen=True, eq=False)
class Surface:
    """What a primitive says of its images' places: its `sets` of texture coordinates (V, 2) by
    number, and its triangles (T, 3)."""

    sets: Mapping[int, F64]
    triangles: I64

    def of(self, frame: UvFrame) -> F64:
        """(V, 2) coordinates of a frame."""
        uvs = self.sets[frame.uv_set]
        return uvs if frame.matrix is None else np.asarray(uvs @ frame.matrix.T)


@dataclass(frozen=True, eq=False)
class Brought:
    """A material whose images lie by `uvs` (V, 2), and what is not right in it."""

    material: Material
    uvs: F32
    problems: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Layout:
    """Textures by slot for coordinates (V, 2), and how well these serve."""

    uvs: F64
    textures: Mapping[str, Any]
    conflicts: Mapping[str, float]
    coarse: tuple[str, ...]

    @property
    def is_right(self) -> bool:
        return max(self.conflicts.values()) <= SMALL_CONFLICT and not self.coarse

    @property
    def order(self) -> tuple[float, int]:
        """Smaller is better."""
        worst = max(self.conflicts.values())
        return (worst if worst > SMALL_CONFLICT else 0.0, len(self.coarse))


def brought_together(
    material: Material,
    uses: Mapping[str, ImageUse],
    surface: Surface,
    *,
    has_tangents: bool = False,
) -> Brought:
    """`material` on `surface`, the images of `uses` (by its field) in one set of coordinates.

    `has_tangents`: the surface says itself where its normal map's bumps lean.
    """
    # Each set of coordinates is tried as the common one, that of the normal map first, whose
    # directions then need no turn, until one is without overlap.
    best: _Layout | None = None
    for frame, uvs in _candidates(uses, surface):
        found = _layout(uses, surface, frame, uvs, has_tangents=has_tangents)
        if best is None or found.order < best.order:
            best = found
        if best.is_right:
            break
    assert best is not None
    # Where none is without, the least wrong is taken, and says how wrong it is.
    problems = [
        f"{slot} overlaps itself in each set of texture coordinates, and is wrong on "
        f"{max(share, 0.01):.0%} of the surface"
        for slot, share in best.conflicts.items()
        if share > SMALL_CONFLICT
    ]
    problems += [f"{slot} is drawn again with {MOST_SIDE} texels, too few" for slot in best.coarse]
    made = replace(material, **best.textures)
    return Brought(made, best.uvs.astype(np.float32), tuple(problems))


def _candidates(
    uses: Mapping[str, ImageUse], surface: Surface
) -> Iterator[tuple[UvFrame | None, F64]]:
    """Frames of the images, that of normals first, whose bumps then stay as they are; at last
    charts side by side, in none."""
    known = set()
    # One candidate for each distinct frame, however many images share it.
    for use in sorted(uses.items(), key=lambda item: item[0] != "normal_texture"):
        frame = UvFrame(use[1].uv_set, use[1].matrix)
        if frame.key not in known:
            known.add(frame.key)
            yield frame, surface.of(frame)
    first = next(iter(uses.values()))
    yield None, side_by_side(surface.of(UvFrame(first.uv_set, first.matrix)), surface.triangles)


def _layout(
    uses: Mapping[str, ImageUse],
    surface: Surface,
    frame: UvFrame | None,
    uvs: F64,
    *,
    has_tangents: bool,
) -> _Layout:
    textures, conflicts, coarse = {}, {}, []
    for slot, use in uses.items():
        # An image that lies in the frame but for scale and offset keeps its pixels.
        scale = None if frame is None else scale_in(use, frame)
        if scale is not None:
            textures[slot], conflicts[slot] = replace(use.texture, scale=scale), 0.0
            continue
        leans = slot == "normal_texture" and not has_tangents
        made = _drawn_again(use, surface, uvs, leans=leans)
        textures[slot], conflicts[slot] = made.texture, made.conflict
        coarse += [slot] * made.is_coarse
    return _Layout(uvs, textures, conflicts, tuple(coarse))


def _drawn_again(use: ImageUse, surface: Surface, uvs: F64, *, leans: bool) -> Baked:
    # From where an image lies in the file to where it will lie, by the triangles' corners.
    source = surface.of(UvFrame(use.uv_set, use.matrix)) + np.array(use.texture.offset)
    charts = Charts(uvs[surface.triangles], source[surface.triangles])
    return baked(use.texture, charts, is_normal=leans)


def side_by_side(uvs: F64, triangles: I64) -> F64:
    """Coordinates (V, 2) moved so that no two charts overlap: parts that share no vertex."""
    chart = _charts(len(uvs), triangles)
    count = int(chart.max()) + 1
    # The box of each chart in the old coordinates.
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.minimum.at(low, chart, uvs)
    np.maximum.at(high, chart, uvs)
    size = high - low
    # In rows, the highest charts first.
    side = max(math.sqrt(float(size.prod(axis=1).sum())), float(size.max()), 1e-9)
    gap = _GAP * side
    corner = np.zeros((count, 2))
    x = y = row_height = 0.0
    for k in np.argsort(-size[:, 1], kind="stable"):
        # A chart that no longer fits begins the next row.
        if x > 0.0 and x + size[k, 0] > side:
            x, y, row_height = 0.0, y + row_height + gap, 0.0
        corner[k] = x, y
        x, row_height = x + size[k, 0] + gap, max(row_height, size[k, 1])
    # Every vertex moves with its chart.
    return np.asarray(uvs + (corner - low)[chart])


def _charts(vertex_count: int, triangles: I64) -> I64:
    """(V,) the number of the chart that each vertex belongs to."""
    label = np.arange(vertex_count)
    while True:
        # Each takes the least label around it, then that one's own.
        least = label.copy()
        lowest = label[triangles].min(axis=1)
        np.minimum.at(least, triangles, lowest[:, None])
        np.minimum.at(least, label[triangles], lowest[:, None])
        least = least[least]
        if np.array_equal(least, label):
            return np.unique(label, return_inverse=True)[1].astype(np.int64)
        label = least
