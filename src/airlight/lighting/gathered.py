"""The field of a final gather: irradiance of each pixel of one view, instead of lattices'."""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.memory import Texture


@dataclass(frozen=True, eq=False)
class Mirrored:
    """What smooth surfaces mirror towards the eye, W m^-2 sr^-1, as textures of the image's size.

    sky    of the environment
    light  of all else; both have a = 1 where a ray was followed
    """

    sky: Texture
    light: Texture


@dataclass(frozen=True, eq=False)
class Gathered:
    """What rays gathered for the pixels of a view, W m^-2, as textures of the image's size.

    irradiance  of surfaces that the rays met
    sky         of the environment, where they left the scene
    mirrored    beside it, what smooth surfaces mirror, where the scene has any
    """

    irradiance: Texture
    sky: Texture
    mirrored: Mirrored | None = None

    @property
    def bound(self) -> dict[str, Texture]:
        """By slot name, for the lighting pass."""
        found = {"gathered_irradiance": self.irradiance, "gathered_sky": self.sky}
        # Where no surface is smooth, nothing is mirrored.
        if self.mirrored is not None:
            found |= {"mirrored_light": self.mirrored.light, "mirrored_sky": self.mirrored.sky}
        return found
