"""What a scheme is to the solver of a medium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ..gpu.commands import Commands
from ..maths.ordinates import Ordinates
from ..maths.transforms import F64
from ..scene.lights import Light
from .delta.diffuse import Diffuse
from .delta.emission import Emission
from .light.incident import IncidentLight
from .light.table import LocalLight
from .light.visibility import Surfaces
from .medium.placement import MediumParams


class Transport(Protocol):
    """A scheme: how the light of the ordinates spreads in one medium."""

    light: IncidentLight
    diffuse: Diffuse
    has_mean: bool
    """Whether it knows the light that the reduced medium scatters, `Emission.mean`."""

    @property
    def iterations(self) -> int:
        """Propagation steps from cell to cell; 0 where there are none."""

    def write(
        self,
        ordinates: Ordinates,
        local: Sequence[LocalLight],
        scale: float = 0.0,
        *,
        virtual: int = 0,
    ) -> None:
        """Upload the light of a frame."""

    def write_surfaces(
        self, ordinates: Ordinates, lights: tuple[Light, ...], surfaces: Surfaces
    ) -> None:
        """Take the surfaces that shade the medium."""

    def encode_medium(self, commands: Commands, params: MediumParams) -> None:
        """Take a changed medium."""

    def encode(self, commands: Commands, params: MediumParams, eye: F64 | None = None) -> None:
        """Solve the light of the scene."""

    def encode_others(self, commands: Commands) -> None:
        """Solve again, with the light that other media scatter."""

    def encode_view(
        self, commands: Commands, params: MediumParams, eye: F64, emission: Emission
    ) -> None:
        """Fill `emission` for an eye (3,), m in the frame of the medium."""
