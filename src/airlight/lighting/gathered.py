"""The field of a final gather: irradiance of each pixel of one view, instead of lattices'."""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.memory import Texture


@dataclass(frozen=True, eq=False)
class Gathered:
    """What rays gathered for the pixels of a view, W m^-2, as textures of the image's size.

    irradiance  of surfaces that the rays met
    sky         of the environment, where they left the scene
    """

    irradiance: Texture
    sky: Texture

    @property
    def bound(self) -> dict[str, Texture]:
        """By slot name, for the lighting pass."""
        return {"gathered_irradiance": self.irradiance, "gathered_sky": self.sky}
