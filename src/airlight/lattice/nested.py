"""Nested lattices: one over the scene, finer ones before the camera, one around all.

Kaplanyan2010 section 4: each is finer by a ratio, displaced along the view, and moves in whole
cells of its own, so that the light injected into a cell does not depend on the camera.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..maths.arrays import F64
from ..maths.transforms import triple
from .placement import Fade, Placement, Triple, fitted, tiled

AHEAD = 0.5
"""How far ahead of the eye a lattice's centre is, in halves of its sides."""
BORDER = 1.5
"""Outermost cells that surfaces do not read: a lattice moves in steps, its fading smoothly."""
FADING = 2.5
"""Cells over which the next larger lattice takes over."""
MARGIN = 2
"""Cells beyond the scene that a lattice may reach: where it just misses the scene's end, its
fading has left what it does not cover."""
SLACK = 0.75
"""How far, in cells, a lattice may be from where it should be: an eye that trembles moves none."""
_NEVER_M = 1e6

Box = tuple[Triple, Triple]


@dataclass(frozen=True)
class Nest:
    """Lattices from the finest to the coarsest, as `nested` makes them.

    `low`, `high`: the box that they are for, metres along the axes that all of them have. `inner`:
    its part that all but the largest are for, if they do not reach as far.
    """

    low: Triple
    high: Triple
    levels: tuple[Placement, ...]
    inner: Box | None = None

    @property
    def texture_size(self) -> tuple[int, int, int]:
        """The size in cells of textures that hold all lattices, one above the other."""
        # Lattices lie one above the other along y; other sides fit the largest.
        counts = np.array([level.count for level in self.levels])
        rows = int(counts[:, 1].sum())
        return (int(counts[:, 0].max()), rows, int(counts[:, 2].max()))

    def follows(self, level: int) -> bool:
        """Whether a lattice moves with the camera."""
        return level < self._last_inner

    @property
    def over_inner(self) -> Placement:
        """The largest lattice of those for the `inner` part; the largest of all without one."""
        return self.levels[self._last_inner]

    @property
    def _last_inner(self) -> int:
        return len(self.levels) - (1 if self.inner is None else 2)


def nested(
    low: Sequence[float] | F64,
    high: Sequence[float] | F64,
    resolution: int,
    *,
    count: int = 1,
    ratio: float = 2.0,
    finest_m: float = 0.0,
    whole: Placement | None = None,
) -> Nest:
    """At most `count` lattices of up to `resolution` cells a side for the box low..high (metres
    along the axes of `whole`, the coarsest of them; the world's, and `fitted`, if not given).

    Cells of neighbours differ by `ratio`. The coarsest covers the box: nothing is dark for being
    beyond all lattices. With `finest_m` the finest has sides of that many metres, and the coarsest
    is larger than its neighbour by what that leaves; lattices that would be no finer than it are
    left out. Raises SettingsError for an empty box.
    """
    # Cells from the coarsest lattice down by the ratio, or from the finest side up.
    whole = whole or fitted(low, high, resolution)
    cells = [whole.cell / ratio**k for k in range(count - 1, -1, -1)]
    if finest_m > 0.0:
        finer = [finest_m / resolution * ratio**k for k in range(count - 1)]
        cells = [c for c in finer if c < whole.cell] + [whole.cell]
    # As many cells as the box needs, at most the resolution; rows of textures one above the other.
    box = np.subtract(high, low)
    levels, row = [], 0
    for cell in cells:
        placement = replace(whole, first_row=row)
        if cell < whole.cell:
            needed = np.minimum(np.ceil(box / cell - 1e-9) + 2 * MARGIN, resolution)
            placement = Placement(whole.origin, cell, tiled(needed), row, axes=whole.axes)
        levels.append(placement)
        row += placement.count[1]
    return Nest(triple(np.asarray(low)), triple(np.asarray(high)), tuple(levels))


def surrounded(nest: Nest, around: Box, resolution: int) -> Nest:
    """A nest with one lattice more, for the box `around` that of the others."""
    # Cells over the larger box, in rows after those of the others.
    *finer, whole = nest.levels
    outer = fitted(*around, resolution, whole.axes)
    outer = replace(outer, first_row=whole.first_row + whole.count[1])
    made = Nest(*around, (*nest.levels, outer), inner=(nest.low, nest.high))
    # It takes over at the borders of the largest of the others. Finer ones stay inside of those, so
    # that not too many lattices fade into each other at one point.
    low, high = whole.bounds
    whole = _with_borders(made, whole, 0.5 * (low + high))
    fade = whole.borders
    core_low = np.maximum(nest.low, np.add(fade.low, fade.low_width))
    core_high = np.minimum(nest.high, np.subtract(fade.high, fade.high_width))
    inner = (triple(core_low), triple(core_high))
    return replace(made, levels=(*finer, whole, outer), inner=inner)


def wanted_centre(nest: Nest, level: int, eye: F64, look: F64) -> F64:
    """Where the middle of a lattice should be (3,), metres along its axes.

    Ahead of `eye` along `look`, both of the world, inside the box where it reaches that far:
    nothing is lit beyond.
    """
    # In the lattice's own axes, as all that follows.
    placement = nest.levels[level]
    eye, look = np.array(placement.axes) @ eye, np.array(placement.axes) @ look
    half = 0.5 * placement.cell * np.array(placement.count)
    direction = look / max(float(np.linalg.norm(look)), 1e-30)
    low, high = _room(nest.inner or (nest.low, nest.high), placement)
    # Ahead of the eye, so far that it stays inside; a lattice larger than the box is centred in
    # it.
    reach = AHEAD * half * direction
    inner_low, inner_high = low + half, high - half
    middle = 0.5 * (low + high)
    centre = np.clip(eye + reach, inner_low, np.maximum(inner_low, inner_high))
    return np.where(inner_low >= inner_high, middle, centre)


def snapped(nest: Nest, level: int, centre: F64, before: Placement | None) -> Placement:
    """A lattice around `centre` on the grid of its own cells, or `before` where that is near.

    Grids of all levels that move have their box's lower corner in common.
    """
    # Where its lower corner would be, in cells from the box's corner.
    placement = nest.levels[level]
    base = np.array(nest.over_inner.origin)
    ideal = (centre - base) / placement.cell - 0.5 * np.array(placement.count)
    # Hysteresis: an eye that trembles across the border of a cell moves no lattice.
    if before is not None:
        now = np.round((np.array(before.origin) - base) / placement.cell)
        if (np.abs(now - ideal) <= SLACK).all():
            return replace(before, fade=None)
    # Moves are of whole cells: what is injected into a cell does not depend on the camera.
    origin = base + placement.cell * np.round(ideal)
    return replace(placement, origin=triple(origin))


def must_move(placement: Placement, centre: F64) -> bool:
    """Whether a lattice is so far from its wanted centre that its borders would be read."""
    # Off by more cells than the border has, a fading would reach beyond the lattice.
    low, high = placement.bounds
    off = np.abs(0.5 * (low + high) - centre)
    return bool((off > BORDER * placement.cell).any())


def faded(nest: Nest, level: int, placement: Placement, centre: F64) -> Placement:
    """The lattice with the borders at which the next larger one takes over.

    They follow `centre`, not the cells: nothing jumps where the lattice does. Where the lattice
    nears the box's side there is less and less to take over, and the border moves out of it.
    """
    return _with_borders(nest, placement, centre) if nest.follows(level) else placement


def _with_borders(nest: Nest, placement: Placement, centre: F64) -> Placement:
    # From the wanted centre, in from the borders unless those are the box's own sides.
    cell = placement.cell
    half = 0.5 * cell * np.array(placement.count)
    room_low, room_high = _room((nest.low, nest.high), placement)
    low, high = centre - half, centre + half
    # A side inside the room fades before it ends; one that is the room's own never does.
    inset_low, inset_high = (
        np.where(gap > 0.0, np.minimum(gap, (BORDER + FADING) * cell) - FADING * cell, -_NEVER_M)
        for gap in (low - room_low, room_high - high)
    )
    width = (FADING * cell,) * 3
    return replace(
        placement, fade=Fade(triple(low + inset_low), width, triple(high - inset_high), width)
    )


def shares(levels: Sequence[Placement], points: F64) -> F64:
    """(L, ...): the share of each lattice, the finest first, in the light at `points` (..., 3).

    Points are metres of the world. They add up to 1. Twin: the loop over `lattice_weight` in
    lighting/lighting.wgsl.
    """
    left = np.ones(points.shape[:-1])
    found = []
    # A lattice's share falls off towards its borders, of that which finer ones have not taken.
    for level in levels:
        fade, own = level.borders, points @ np.array(level.axes).T
        low = (own - np.array(fade.low)) / np.array(fade.low_width)
        high = (np.array(fade.high) - own) / np.array(fade.high_width)
        share = left * np.clip(np.minimum(low, high).min(axis=-1), 0.0, 1.0)
        found.append(share)
        left = left - share
    return np.stack(found)


def _room(box: Box, placement: Placement) -> tuple[F64, F64]:
    """The box that a lattice stays in, with a margin of its cells."""
    margin = MARGIN * placement.cell
    return np.array(box[0]) - margin, np.array(box[1]) + margin
