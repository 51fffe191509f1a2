"""What lights media in a frame, from where an eye sees them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...fields import ReflectedLight
from ...maths.transforms import F64
from ...scene.environment import Environment
from ...scene.lights import Light
from ..medium.surrounding import SurroundingMedium
from .importance import Look
from .visibility import Surfaces


@dataclass(frozen=True, eq=False)
class Illumination:
    """The light on media and the eye that sees them.

    `eye` (3,), m in the world. `surfaces`: those that shade media. `reflected`: what they reflect
    into them, from a lattice. `look`: the camera, for the importance of ordinates. `around`: what
    the media lie in and that lattice has solved.
    """

    lights: tuple[Light, ...]
    environment: Environment | None
    eye: F64
    surfaces: Surfaces | None = None
    reflected: ReflectedLight | None = None
    look: Look | None = None
    around: SurroundingMedium | None = None

    @property
    def versions(self) -> tuple[Any, ...]:
        """Of the surfaces, of reflected light and of the medium around; equal: none changed."""
        of_surfaces = () if self.surfaces is None else self.surfaces.version
        reflected = () if self.reflected is None else self.reflected.version
        return (*of_surfaces, *reflected, self.around)
