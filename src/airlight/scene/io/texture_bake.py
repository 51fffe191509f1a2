"""Images drawn again in other texture coordinates of the same triangles.

A surface has one set of texture coordinates here. An image that lies by others is resampled: each
texel of the new image asks where in the old one its point of the surface lies.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...maths.arrays import F64, I64, U8
from ...maths.colour import srgb_decode, srgb_encode
from ..material import Texture
from ..texels import interpolated

MOST_SIDE = 4096
"""Texels along a side of an image that is made here."""
LEAST_SIDE = 256
"""Of a smaller one, charts that lie side by side would blend at their edges."""
FINER = 2.0
"""Texels for each of the old image, along a side: interpolating a second time blurs little."""
SAME_BYTES = 8
"""By how much two triangles that claim one texel may differ there, of 255."""
MARGIN = 2.0
"""Texels around a triangle that are drawn as if it went on; the new image has them around it."""
_BATCH = 1 << 19  # texels drawn together


@dataclass(frozen=True, eq=False)
class Charts:
    """Triangles in two sets of texture coordinates: `to` (T, 3, 2) is where the new image has
    them, `source` (T, 3, 2) where the old one does, whose sides are 1."""

    to: F64
    source: F64

    @property
    def is_flat(self) -> NDArray[np.bool_]:
        """(T,) whether a triangle has no area in the new image."""
        return np.asarray(np.abs(np.linalg.det(_edges(self.to))) < 1e-14)

    @property
    def lost_share(self) -> float:
        """The share of triangles that have an area in the old image alone."""
        has_area = np.abs(np.linalg.det(_edges(self.source))) >= 1e-14
        return float((self.is_flat & has_area).mean())

    def solid(self) -> Charts:
        """Those with an area in the new image."""
        kept = ~self.is_flat
        return Charts(self.to[kept], self.source[kept])

    @property
    def jacobians(self) -> F64:
        """d source / d to, (T, 2, 2), of triangles with an area."""
        return np.asarray(_edges(self.source) @ np.linalg.inv(_edges(self.to)))


@dataclass(frozen=True, eq=False)
class Baked:
    """A new image, which lies by `Charts.to`; `conflict`: the share of it that several triangles
    claim for different colours; `is_coarse`: the old image has finer texels."""

    texture: Texture
    conflict: float
    is_coarse: bool


def baked(texture: Texture, charts: Charts, *, is_normal: bool = False) -> Baked:
    """`texture` in the coordinates `charts.to`; tangent-space normals are turned with it."""
    # Without an area in the new image there is nothing to draw.
    solid = charts.solid()
    if not len(solid.to):
        return Baked(texture, 1.0, is_coarse=False)
    low = solid.to.min(axis=(0, 1))
    span = np.maximum(solid.to.max(axis=(0, 1)) - low, 1e-9)
    if is_normal:  # bumps lean where u and v have different scales
        span = np.full(2, span.max())
    # As many texels as the original has there, with a margin that filtering may reach into.
    size, is_coarse = _size(texture, solid, span)
    inner = size - 2.0 * MARGIN
    placed = Charts((solid.to - low) / span * inner + MARGIN, solid.source)
    pixels, conflict = _drawn(texture, placed, size, is_normal=is_normal)
    # The transform that takes the charts' coordinates to the new image.
    scale = inner / span / size
    offset = MARGIN / size - low * scale
    made = replace(
        texture,
        pixels=pixels,
        wrap=("clamp", "clamp"),
        scale=(float(scale[0]), float(scale[1])),
        offset=(float(offset[0]), float(offset[1])),
    )
    return Baked(made, max(conflict, charts.lost_share), is_coarse)


def _edges(corners: F64) -> F64:
    """(T, 2, 2): the edges from each triangle's first corner, in columns."""
    return np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)


def _size(texture: Texture, charts: Charts, span: F64) -> tuple[I64, bool]:
    """Width and height of the new image; whether the old one has finer texels."""
    # How many old texels one unit of the new coordinates crosses, for nearly all triangles.
    height, width = texture.pixels.shape[:2]
    per_unit = np.linalg.norm(charts.jacobians * np.array([[width], [height]]), axis=1)
    wanted = np.percentile(per_unit, 95.0, axis=0) * span
    size = np.clip(np.ceil(FINER * wanted + 2.0 * MARGIN), LEAST_SIDE, MOST_SIDE)
    if span[0] == span[1]:  # maps of normals stay as long as wide
        size[:] = size.max()
    return size.astype(np.int64), bool((wanted > size).any())


def _drawn(texture: Texture, placed: Charts, size: I64, *, is_normal: bool) -> tuple[U8, float]:
    """(H, W, 4) pixels of triangles placed in texels, and how far these disagree."""
    # Of each texel: its value, how deep it lies in the triangle that has it, and the least
    # and most that triangles ask of it.
    width, height = (int(n) for n in size)
    old, jacobians = _old_image(texture, placed), placed.jacobians
    new = np.zeros((height * width, 4))
    depth = np.full(height * width, -np.inf)
    lows = np.full((height * width, 4), 255, np.uint8)
    highs = np.zeros_like(lows)
    for which, texel in _covered(placed.to, width, height):
        # Texels in a triangle or within a margin of it, and where they come from in the old image.
        centre: F64 = np.stack([texel % width, texel // width], axis=1).astype(np.float64) + 0.5
        away = centre - placed.to[which, 0]
        inside: F64 = _depth(placed.to[which], centre)
        near = inside >= -MARGIN
        which, texel, away, inside = which[near], texel[near], away[near], inside[near]
        # Each texel by its triangle's map, in the old image.
        at = placed.source[which, 0] + np.einsum("nij,nj->ni", jacobians[which], away)
        values = interpolated(old, at, texture.wrap)
        # Normal maps are in the frame of their texture coordinates, which turn, too.
        if is_normal:
            values = _turned(values, jacobians[which])
        # Of several triangles the one that the texel lies deepest in.
        order = np.argsort(inside, kind="stable")
        order = order[inside[order] > depth[texel[order]]]
        new[texel[order]], depth[texel[order]] = values[order], inside[order]
        # Texels that several triangles claim, with values apart, are a conflict.
        claimed = inside >= 0.0
        bytes_ = _bytes(values[claimed], is_srgb=texture.is_srgb)
        np.minimum.at(lows, texel[claimed], bytes_)
        np.maximum.at(highs, texel[claimed], bytes_)
    is_claimed = depth >= 0.0
    spread = highs[is_claimed].astype(np.int64) - lows[is_claimed]
    conflict = float((spread.max(axis=1) > SAME_BYTES).mean()) if is_claimed.any() else 0.0
    whole = _filled(new.reshape(height, width, 4), np.isfinite(depth).reshape(height, width))
    return _bytes(whole, is_srgb=texture.is_srgb), conflict


def _covered(corners: F64, width: int, height: int) -> Iterator[tuple[I64, I64]]:
    """(triangle, texel) of the boxes around triangles, in batches."""
    # The box of each triangle with its margin, within the image.
    most = np.array([width, height]) - 1
    low = np.clip(np.floor(corners.min(axis=1) - MARGIN), 0, most).astype(np.int64)
    high = np.clip(np.ceil(corners.max(axis=1) + MARGIN), 0, most).astype(np.int64)
    count = high - low + 1
    # A row of a box is what batches are made of.
    owner, y = _ranges(count[:, 1])
    y, lengths = y + low[owner, 1], count[owner, 0]
    batch = np.cumsum(lengths) // _BATCH
    for first, last in zip(*_runs(batch), strict=True):
        row, x = _ranges(lengths[first:last])
        which = owner[first:last][row]
        yield which, y[first:last][row] * width + low[which, 0] + x


def _ranges(counts: I64) -> tuple[I64, I64]:
    """0 .. count of every row, one after the other: the row, and the number within it."""
    row = np.repeat(np.arange(len(counts)), counts)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)


def _runs(values: I64) -> tuple[I64, I64]:
    """First and end of the runs of equal values."""
    first = np.flatnonzero(np.diff(values, prepend=values[0] - 1))
    return first, np.append(first[1:], len(values))


def _depth(corners: F64, at: F64) -> F64:
    """How far inside its triangle (N, 3, 2) a point (N, 2) lies; negative outside."""
    edge = np.roll(corners, -1, axis=1) - corners
    away = at[:, None] - corners
    # Distances from the edges' lines, counted inwards whichever way the corners go round.
    side = np.sign(np.linalg.det(_edges(corners)))[:, None]
    cross = edge[..., 0] * away[..., 1] - edge[..., 1] * away[..., 0]
    length = np.maximum(np.linalg.norm(edge, axis=-1), 1e-30)
    return np.asarray((side * cross / length).min(axis=1))


def _old_image(texture: Texture, placed: Charts) -> F64:
    """(H, W, 4) linear values, averaged where the new image has texels of twice the size."""
    values = texture.pixels / 255.0
    # Filtering is of light, not of code values.
    if texture.is_srgb:
        values[..., :3] = srgb_decode(values[..., :3])
    # Old texels per new one, along each axis: halved until there are fewer than two.
    per_texel = np.median(np.linalg.norm(placed.jacobians, axis=2), axis=0)
    for axis, row in ((0, 1), (1, 0)):
        while per_texel[row] * values.shape[axis] >= 2.0 and values.shape[axis] % 2 == 0:
            even, odd = (np.take(values, range(k, values.shape[axis], 2), axis) for k in (0, 1))
            values = (even + odd) / 2.0
    return np.asarray(values)


def _turned(values: F64, jacobians: F64) -> F64:
    """Normals (N, 4) in bytes' range, of the frame of new coordinates.

    A normal map's frame are the gradients of u and v (`wgsl/mapped_normal.wgsl`), the longer one
    of length 1: those of the old coordinates are the Jacobian's rows. Green is up, v down.
    """
    # The longer gradient has length 1, so that the bump keeps its height.
    length = np.linalg.norm(jacobians, axis=2).max(axis=1)
    rows = jacobians / np.maximum(length, 1e-30)[:, None, None]
    bump = values[:, :2] * 2.0 - 1.0
    turned = rows[:, 0] * bump[:, :1] - rows[:, 1] * bump[:, 1:]
    turned[:, 1] *= -1.0
    return np.concatenate([turned * 0.5 + 0.5, values[:, 2:]], axis=1)


def _filled(values: F64, is_there: NDArray[np.bool_]) -> F64:
    """(H, W, 4) with what is missing taken from means over ever larger squares."""
    if is_there.all() or values.shape[:2] == (1, 1):
        return values
    height, width = values.shape[:2]
    # An odd side gets one more row or column, which counts for nothing.
    padding = ((0, height % 2), (0, width % 2))
    # Means of what is there over 2 x 2 texels, filled in turn the same way.
    weight = np.pad(is_there.astype(np.float64), padding)[..., None]
    sums = np.pad(values * is_there[..., None], (*padding, (0, 0)))
    counts, sums = (
        x.reshape(x.shape[0] // 2, 2, x.shape[1] // 2, 2, -1).sum(axis=(1, 3))
        for x in (weight, sums)
    )
    coarse = _filled(sums / np.maximum(counts, 1.0), counts[..., 0] > 0.0)
    near = coarse.repeat(2, axis=0).repeat(2, axis=1)[:height, :width]
    return np.where(is_there[..., None], values, near)


def _bytes(values: F64, *, is_srgb: bool) -> U8:
    """Pixels of linear values."""
    if is_srgb:
        values = np.concatenate([srgb_encode(values[..., :3]), values[..., 3:]], axis=-1)
    return np.asarray(np.round(np.clip(values, 0.0, 1.0) * 255.0).astype(np.uint8))
