"""Shadow maps as quad-trees of planar facets, and the triangles that bound what they shadow.

A square of texels is one facet where a plane fits its depths; else it is opened, down to single
texels with steps between them. Squares beside each other differ by one level at most, so that
facets share their corners and the surface has no cracks: a facet whose neighbour is finer is a fan.
Between facets stand walls along the light, which run to infinity where the map is empty or ends.
All of it is made on the device: planes from the texels up, triangle counts from the leaves up
(Ziegler2006), positions in the list from the root down. The order is the same in every run.
Source: Billeter2010 tessellates a shadow map where its depths are uneven. differs: that
interpolates across depth edges; here those are steps.
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, u32
from ...gpu.memory import Buffer
from ...gpu.rows import table
from ...gpu.slots import Slot, storage, texture, uniform
from ...surface.light_views import LightViewData
from ...surface.shadow import ShadowMaps


class FacetParams(Struct):
    """One level of the trees of an array of maps."""

    side = u32("texels of the map, rounded up to a power of two")
    level = u32()
    top = u32("the level of one square")
    resolution = u32("texels of the map")
    layer = u32("of passes over one")
    tolerance = f32("texels that a facet may lie off its depths, at 45 degrees")


class Draw(Struct):
    """Arguments of an indirect draw."""

    vertices = u32()
    instances = u32()
    first_vertex = u32()
    first_instance = u32()


TREE_SLOTS: tuple[Slot, ...] = (
    uniform("tree", FacetParams),
    texture("shadows", "2d-array", "depth"),
)


class _Fit(ComputePass):
    slots = (*TREE_SLOTS, table("views", LightViewData), storage("facets", "vec4f", "read_write"))
    workgroup = (16, 8, 1)


class _Counts(ComputePass):
    slots = (*TREE_SLOTS, storage("facets", "vec4f"), storage("places", "u32", "read_write"))
    workgroup = (16, 8, 1)
    file = "facet_counts.wgsl"


class _List(ComputePass):
    slots = (
        *_Counts.slots,
        storage("triangles", "u32", "read_write"),
        storage("draws", Draw, "read_write"),
    )
    workgroup = (16, 8, 1)
    file = "facet_list.wgsl"


class FacetTrees:
    """A tree per layer of `maps`; `triangles` and `draws` are what there is to draw of each."""

    def __init__(self, gpu: Gpu, maps: ShadowMaps, tolerance: float) -> None:
        self.maps, self.tolerance = maps, tolerance
        # A tree over the smallest power of two that holds the map.
        self.side = 1 << (max(2, maps.depth.size[0]) - 1).bit_length()
        self.top = self.side.bit_length() - 1
        layers = max(1, maps.layers)
        nodes = layers * (self.side * self.side - 1) // 3
        # At most two triangles for a texel's top and end, two for each edge, four at each corner.
        # Only a map of nothing but noise would be cut short by the device's limit.
        most = 12 * self.side**2 + 16 * self.side if maps.layers else 1
        most = min(most, gpu.limits["max-storage-buffer-binding-size"] // 4)
        self.planes = Buffer(gpu, "facets", 16 * nodes)
        self._counted = Buffer(gpu, "counts of triangles", 4 * nodes)
        self.triangles = [Buffer(gpu, "shadow triangles", 4 * most) for _ in range(layers)]
        self.draws = Buffer(gpu, "shadow draws", Draw.dtype.itemsize * layers, indirect=True)
        self._fit, self._counts, self._list = _Fit(gpu), _Counts(gpu), _List(gpu)

    def params(self, level: int = 0, layer: int = 0) -> FacetParams:
        """For passes that read the trees."""
        return FacetParams(
            side=self.side,
            level=level,
            top=self.top,
            resolution=self.maps.depth.size[0],
            layer=layer,
            tolerance=self.tolerance,
        )

    def encode(self, commands: Commands) -> None:
        """Compute the trees and their triangles from the maps."""
        if not self.maps.layers:
            return
        # The same resources for all levels, which read what the ones before wrote.
        levels = [self.params(level) for level in range(1, self.top + 1)]
        shared = {"shadows": self.maps.depth, "facets": self.planes}
        # Planes from the leaves up, where one is near enough to all below it.
        for tree in levels:
            self._fit.dispatch(
                commands, self._squares(tree), tree=tree, views=self.maps.views, **shared
            )
        # How many triangles each square has to draw, summed upwards.
        for tree in levels:
            self._counts.dispatch(
                commands, self._squares(tree), tree=tree, places=self._counted, **shared
            )
        # From the root down, the counts become where each square writes its triangles.
        for layer, triangles in enumerate(self.triangles):
            for level in range(self.top, 0, -1):
                tree = self.params(level, layer)
                self._list.dispatch(
                    commands,
                    self._squares(tree)[:2],
                    tree=tree,
                    places=self._counted,
                    triangles=triangles,
                    draws=self.draws,
                    **shared,
                )

    def bound(self, layer: int) -> dict[str, Any]:
        """By slot name, for passes that draw a layer's triangles."""
        return {
            "tree": self.params(layer=layer),
            "shadows": self.maps.depth,
            "views": self.maps.views,
            "facets": self.planes,
            "triangles": self.triangles[layer],
        }

    def _squares(self, tree: FacetParams) -> tuple[int, int, int]:
        squares = self.side >> int(tree.record["level"])
        return squares, squares, self.maps.layers
