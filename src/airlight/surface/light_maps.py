"""Reflective shadow maps of all lights of a scene.

Directional lights share one array of maps, local lights another of half the side. The light of
the first comes past edges, of roofs, windows or columns, which wander over texels as it moves. So
their maps may be drawn finer than virtual point lights are, `BLOCK` texels to a side of each, and
are turned about the light, so that no row of texels lies along upright walls.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..maths.transforms import F64
from ..scene.lights import DirectionalLight, Light
from .geometry import GpuScene
from .light_views import light_views, view_count
from .reflective import ReflectiveShadowMaps

SMALLEST_LOCAL = 8  # texels
BLOCK = 2
"""Texels along each side of a block that is one virtual light, in maps of directional lights."""
TURN_DEG = 20.0
"""Of the texels of a directional light's map about its light: along no wall."""


class LightMaps:
    """`groups`: the maps of directional lights, then those of local lights.

    `owners`: for each group and each of its layers, the row of its light in the scene's list. The
    number and the kinds of lights are fixed.
    """

    def __init__(
        self, gpu: Gpu, lights: Sequence[Light], resolution: int, *, block: int = 1
    ) -> None:
        """`resolution`: blocks along the side of a directional light's map, each of `block` by
        `block` texels.
        """
        # Local lights have half the side: they have six maps, or a narrow one.
        sides = (resolution * block, max(SMALLEST_LOCAL, resolution // 2))
        names, blocks = ("directional", "local"), (block, 1)

        # A light of six views owns six layers in a row.
        self.owners = [
            [row for row, light in group for _ in range(view_count(light))]
            for group in _by_kind(lights)
        ]
        self.groups = tuple(
            ReflectiveShadowMaps(gpu, name, side, len(owners), block=n)
            for name, side, n, owners in zip(names, sides, blocks, self.owners, strict=True)
        )

    @property
    def version(self) -> tuple[int, ...]:
        """A value that changes whenever a map is drawn."""
        return tuple(maps.version for maps in self.groups)

    def encode(
        self, commands: Commands, meshes: GpuScene, lights: Sequence[Light], low: F64, high: F64
    ) -> bool:
        """Draw the maps that changed; returns whether any did.

        low..high: the box that the lights must see, metres.
        """
        # Each group's views fit the box; a group without lights draws nothing.
        is_drawn = False
        for group, maps in zip(_by_kind(lights), self.groups, strict=True):
            if group:
                own = [light for _, light in group]
                views = light_views(own, low, high, maps.resolution, turn_deg=TURN_DEG)
                is_drawn = maps.encode(commands, meshes, own, views) or is_drawn
        return is_drawn


_Rows = list[tuple[int, Light]]


def _by_kind(lights: Sequence[Light]) -> tuple[_Rows, _Rows]:
    """(row, light) of all directional lights, and of all others."""
    rows = list(enumerate(lights))
    directional: _Rows = [row for row in rows if isinstance(row[1], DirectionalLight)]
    return directional, [row for row in rows if not isinstance(row[1], DirectionalLight)]
