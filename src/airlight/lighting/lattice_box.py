"""The box that lattices cover: surfaces, volumes and, if they hold its light, the medium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import SettingsError
from ..lattice.facing import wall_axes
from ..lattice.fitting import at_walls, walls_along
from ..lattice.nested import Box, Nest, surrounded
from ..lattice.placement import STRAIGHT, Axes, Placement, fitted
from ..maths.transforms import box_along, box_around, triple
from ..scene.along import whole_bounds_along
from ..scene.checks import F64
from ..scene.light_shapes import furnished
from ..scene.medium import medium_box
from ..scene.scene import Scene
from .reach import eyes_of, reach_of

MEDIUM_BEYOND = 2.0
"""Of the surfaces' longest side: how far their lattices reach into the medium. A camera that
frames an object stands about so far away, in a medium that fills the scene up to its camera."""
_PART = 0.5
"""Of a cell: a medium that ends so close to a lattice has no other one."""
MOST_CELLS = 256
MOST_MORE = 1.5
"""Times as many cells along a side at most, where a turned lattice covers a medium."""
_HAIR = 0.01
"""Of the surfaces' longest side: a medium that ends so close to a wall adds nothing."""


def lattice_axes(scene: Scene, *, follows_walls: bool = True) -> Axes:
    """Unit vectors along which a scene's lattices lie: the walls', or the world's.

    Surfaces of area lights count where there are no others alone, as for the box.
    """
    return wall_axes(furnished(scene).meshes) if follows_walls else STRAIGHT


def lattice_box(
    scene: Scene, bounds: Sequence[float] = (), *, in_medium: bool = False, axes: Axes = STRAIGHT
) -> tuple[Any, Any]:
    """Lower and upper corner, metres along `axes`, of what lattices cover.

    `bounds`: the setting of that name, six numbers, a box of the world, which has the last word.
    `in_medium`: whether the lattice holds light in the medium: then what that fills is covered,
    too. Raises SettingsError for bounds that are not a box.
    """
    turn = np.array(axes)
    # Without the setting: what the scene fills, and its media where the lattice holds their light.
    if not bounds:
        if in_medium:
            return _with_medium(scene, turn)
        return whole_bounds_along(furnished(scene), turn)
    if len(bounds) != 6:
        raise SettingsError(
            f"setting bounds has {len(bounds)} numbers", remedy="Give x0,y0,z0,x1,y1,z1"
        )
    low, high = bounds[:3], bounds[3:]
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise SettingsError(f"setting bounds is empty: {list(low)} to {list(high)}")
    return (low, high) if axes == STRAIGHT else box_along(turn, low, high)


def lattice_extent(
    scene: Scene, bounds: Sequence[float], resolution: int, *, in_medium: bool, axes: Axes
) -> tuple[Any, Any, int]:
    """The `lattice_box`, and how many cells its longest side has where `resolution` are asked for.

    A turned lattice covers more for what the medium fills, a box of the world. It is the lattice
    that would cover a medium turned with the walls, and whole cells around that: what it has of
    surfaces is the same however the scene is turned. Raises SettingsError.
    """
    low, high = lattice_box(scene, bounds, in_medium=in_medium, axes=axes)
    medium = scene.medium
    is_filled = in_medium and medium is not None and medium.bounds is None and not medium.endless
    if axes == STRAIGHT or bounds or medium is None or not is_filled:
        return low, high, resolution
    # The lattice in a medium that is turned with the walls.
    turn = np.array(axes)
    seen = whole_bounds_along(scene, turn)
    filled = [medium_box(medium, *seen, turn @ np.asarray(eye)) for eye in eyes_of(scene)]
    upright = fitted(
        *_reached(*whole_bounds_along(furnished(scene), turn), filled), resolution, axes
    )
    # Whole cells below and above it, in pairs, unless there were too many.
    cell, first, count = upright.cell, np.array(upright.origin), np.array(upright.count)
    below = np.ceil(np.maximum(first - low, 0.0) / cell - _HAIR)
    above = np.ceil(np.maximum(high - first - cell * count, 0.0) / cell - _HAIR)
    above += (below + above) % 2
    more = int((count + below + above).max())
    if more > min(MOST_MORE * resolution, MOST_CELLS):
        return low, high, resolution
    # One cell of margin at either end is added again.
    return first + cell * (1.0 - below), first + cell * (count + above - 1.0), more


def whole_lattice(
    scene: Scene, low: Any, high: Any, resolution: int, *, axes: Axes, follows_walls: bool = True
) -> Placement:
    """The lattice over a box, metres along `axes`, whose cells end at the scene's walls."""
    placement = fitted(low, high, resolution, axes)
    if not follows_walls:
        return placement
    return at_walls(placement, low, high, walls_along(furnished(scene).meshes, axes))


def _with_medium(scene: Scene, turn: F64) -> tuple[F64, F64]:
    """Surfaces and the medium around them, as far as cells are worth it; m along `turn`.

    The far light of an endless medium is in a table of its own (`media.half_space`).
    """
    low, high = whole_bounds_along(furnished(scene), turn)
    medium = scene.medium
    if medium is None or medium.endless:
        return low, high
    # What it fills is a box of the world, however the lattice is turned.
    seen = whole_bounds_along(scene, np.eye(3))
    boxes = [box_along(turn, *medium_box(medium, *seen, eye)) for eye in eyes_of(scene)]
    return _reached(low, high, boxes)


def with_medium_around(nest: Nest, scene: Scene, bounds: Sequence[float], resolution: int) -> Nest:
    """The `nest`, with one lattice more where the medium goes on far beyond it."""
    around = medium_around(scene, bounds, nest)
    return nest if around is None else surrounded(nest, around, resolution)


def medium_around(scene: Scene, bounds: Sequence[float], nest: Nest) -> Box | None:
    """The box of a `nest` with what a medium fills around it, as far as it is seen.

    In metres along its axes. None where its largest lattice has the medium but for a part of a
    cell, or settings have `bounds` of their own.
    """
    reach = None if bounds else reach_of(scene)
    if reach is None:
        return None
    # The box of the nest, and around it what eyes see of the medium.
    whole = nest.levels[-1]
    filled = reach.along(np.array(whole.axes))
    low, high = np.minimum(nest.low, filled[0]), np.maximum(nest.high, filled[1])
    # A lattice that is turned with the walls covers the corners of an upright box all but.
    first, last = whole.bounds
    beyond = max(float((first - low).max()), float((high - last).max()))
    return (triple(low), triple(high)) if beyond > _PART * whole.cell else None


def _reached(low: F64, high: F64, boxes: Sequence[tuple[Any, Any]]) -> tuple[F64, F64]:
    """The box low..high of surfaces with what a medium in `boxes` adds, as far as it is worth."""
    longest = float(np.subtract(high, low).max())

    def reach(beyond: F64) -> F64:
        return np.where(beyond > _HAIR * longest, np.minimum(beyond, MEDIUM_BEYOND * longest), 0.0)

    # A hair's breadth is worth no cells; very far beyond, cells for surfaces would be too large.
    first, last = box_around(boxes)
    return low - reach(low - first), high + reach(last - high)
