"""What solvers are given and what they yield: the contract that every technique is made of.

    frame    the scene as it is now, and the box that its lights must see
    solver   solve(commands, frame, fields) -> fields     whatever the view
             see(commands, view, fields) -> fields        what depends on the eye
    fields   irradiance -> lighting of surfaces
             scattered, volumes, sky_scatter, far -> marching of media
             reflected -> media that are lit by surfaces

Solvers run in the order of the recipe and see the fields of those before them. Whoever reads a
field does not know which solver it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from .gpu.commands import Commands
from .lattice.irradiance import Irradiance, SkyIrradiance
from .lighting.view import View
from .march.far_air import FarSource
from .march.march import LatticeSource, Source
from .maths.transforms import F64
from .scene.scene import Scene


@dataclass(frozen=True, eq=False)
class Frame:
    """What is to be solved. `low`, `high` (3,), metres: the box that lights must see."""

    scene: Scene
    low: F64
    high: F64

    @property
    def bounds(self) -> tuple[F64, F64]:
        """Its lower and its upper corner."""
        return self.low, self.high


@dataclass(frozen=True, eq=False)
class ReflectedLight:
    """Light that surfaces reflect, as a medium takes it from lattices.

    `version`: equal as long as the light is the same. `knows_media`: whether it was solved with the
    scene's volumes in the lattices, and so holds what there is of it inside them.
    """

    source: LatticeSource
    version: tuple[Any, ...]
    knows_media: bool = False


@dataclass(frozen=True, eq=False)
class Fields:
    """Light that has been solved.

    sky          of the environment on surfaces, W m^-2
    irradiance   of lattices on surfaces, W m^-2
    reflected    by surfaces into media
    scattered    mean radiance on lattices, of which media scatter their share, W m^-2 sr^-1
    sky_scatter  the same of the environment's direct light
    volumes      radiance that solved volumes scatter towards the eye, on grids of their own
    far          light of an endless medium beyond the lattices
    """

    sky: SkyIrradiance
    irradiance: Irradiance | None = None
    reflected: ReflectedLight | None = None
    scattered: LatticeSource | None = None
    sky_scatter: LatticeSource | None = None
    volumes: tuple[Source, ...] = ()
    far: FarSource | None = None


class Solver(Protocol):
    """One of the parts that a technique's light is solved by; made once, used for any frame."""

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Everything that does not depend on the view: `fields`, and what this adds to them."""

    def see(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """What depends on the eye of `view`."""

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""

    def release(self) -> None:
        """Give the memory back."""
