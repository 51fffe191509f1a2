"""The directional lights that stand for the sky, as passes over cells gather them."""

from __future__ import annotations

from ..gpu.memory import Texture
from ..gpu.rows import Table
from ..lighting.kit import Kit
from ..surface.light_table import LightData, packed_lights
from .cell_lights import CellLights
from .reduced_media import sky_capacity


class SkyTable:
    """The rows of a kit's sky lights in `buffer`; `rows` are equal as long as those lights are."""

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        # As large as the sky's lights may ever be many, so that passes keep their buffer.
        self.capacity = max(1, sky_capacity(kit))
        self.buffer = Table(kit.gpu, "sky lights", LightData, self.capacity)
        self.rows = self._written = b""

    @property
    def has_any(self) -> bool:
        """Whether lights stand for the sky, with maps."""
        return bool(self._kit.sky.lights and self._kit.sky.maps.layers)

    def update(self) -> None:
        """Take the lights that stand for the sky now."""
        # The rows tell whether lights are others; without maps nobody reads them.
        table = packed_lights(tuple(self._kit.sky.lights))
        self.rows = table.tobytes()
        if self.has_any and self.rows != self._written:
            self.buffer.write(table)
            self._written = self.rows

    def cell_lights(self, walls: Texture, *, are_lit: bool = True) -> CellLights:
        """These lights with their maps, bound as if they were the scene's; none if not `are_lit`.

        `walls` as `Blockers.walls`.
        """
        # They take the slots of directional lights; those of local lights are bound and not read.
        maps = self._kit.sky.maps
        resources = {
            **self._kit.lights.bound,
            "lights": self.buffer,
            "parallel_views": maps.views,
            "parallel_shadows": maps.depth,
        }
        return CellLights(resources, len(self._kit.sky.lights) if are_lit else 0, walls)
