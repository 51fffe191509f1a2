"""Nested lattices over a scene: what settings say of them, and where they are.

The lattices themselves are in `lattice.nested`; which light goes from one to the next is each
solver's own business.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..lattice.gaps import narrow_gap, nested_count
from ..lattice.nested import Nest, nested
from ..scene.light_shapes import furnished
from ..scene.scene import Scene
from ..scene.settings import setting
from .kit import SurfaceSettings
from .lattice_box import lattice_axes, lattice_extent, whole_lattice, with_medium_around


@dataclass(frozen=True)
class CascadeSettings(SurfaceSettings):
    """The settings of surfaces, and of the lattices that are nested around the camera."""

    cascades: int = setting(
        0,
        "nested lattices, which but for the largest over surfaces follow the camera; "
        "0: as many as give four cells to gaps between surfaces, where one gives less than two; "
        "a medium that reaches far beyond the surfaces has one more",
        low=0,
        high=6,
    )
    cascade_ratio: float = setting(
        2.0, "how much larger the cells of the next lattice are", low=1.25, high=8.0
    )
    cascade_extent: float = setting(
        0.0,
        "side of the finest cascade; 0: cells of all differ by the ratio",
        unit="m",
        low=0.0,
        high=1e6,
    )
    cascade_light: bool = setting(
        True, "whether finer cascades take in light from beyond their borders"
    )


def cascades_nest(
    scene: Scene, settings: CascadeSettings, *, in_medium: bool = False, has_outer: bool = True
) -> Nest:
    """The nested lattices that `settings` ask for, over the scene, its medium too if `in_medium`.

    Where that reaches far beyond the surfaces, one more is for it, unless not `has_outer`.

    Where they leave it open, the gaps between the scene's surfaces say how many there are: a scene
    has the same number wherever its camera and lights go. Raises SettingsError.
    """
    # Along the walls, over surfaces and perhaps their medium, the finest ahead of the camera.
    axes = lattice_axes(scene, follows_walls=settings.follow_walls)
    low, high, resolution = lattice_extent(
        scene, settings.bounds, settings.resolution, in_medium=in_medium, axes=axes
    )
    whole = whole_lattice(
        scene, low, high, resolution, axes=axes, follows_walls=settings.follow_walls
    )
    # As many as it takes for a cell to fit the narrowest gap.
    count, ratio = settings.cascades, settings.cascade_ratio
    if count == 0:
        gap = narrow_gap(furnished(scene).meshes, axes)
        count = nested_count(gap, whole.cell, ratio)
    # The coarsest covers the box, each next one is finer by the ratio.
    nest = nested(
        low,
        high,
        resolution,
        whole=whole,
        count=count,
        ratio=ratio,
        finest_m=settings.cascade_extent,
    )
    # Where the medium goes on, one more.
    if not (in_medium and has_outer):
        return nest
    return with_medium_around(nest, scene, settings.bounds, resolution)
