"""The part that media take in a lattice of reflected light: a protocol of `lpv.solver`.

`techniques.volumes` has the implementation; the solver knows nothing else of media.
"""

from __future__ import annotations

from typing import Protocol

from ..fields import Frame
from ..gpu.commands import Commands
from ..gpu.memory import Buffer
from ..lattice.irradiance import Irradiance
from ..lattice.lookup import LatticeTextures
from ..surface.reflective import ReflectiveShadowMaps


class LatticeMedia(Protocol):
    """The part of media in a lattice of reflected light."""

    def update(self, commands: Commands, frame: Frame) -> None:
        """Bring the media up to date with the frame, before anything else."""

    @property
    def version(self) -> int:
        """A number that differs whenever the media changed."""

    def attenuate(self, commands: Commands) -> None:
        """Attenuate the lights' reflective shadow maps, which are drawn for this frame."""

    def attenuate_sky(self, commands: Commands) -> None:
        """Attenuate the sky's maps likewise."""

    def attenuated(self, maps: ReflectiveShadowMaps) -> ReflectiveShadowMaps:
        """The attenuated maps that stand for `maps`."""

    def block(self, commands: Commands, level: int, geometry: int) -> None:
        """Add the media to the blockers of a lattice; `geometry`: the version of the meshes."""

    def faces(self, level: int) -> Buffer:
        """The faces between the cells of a lattice, with surfaces and media as blockers."""

    def send(self, commands: Commands, level: int, scale: float) -> None:
        """Solve a lattice with the light that media scatter.

        Surfaces read `textures`, media the solver's own, which this fills, too.
        """

    @property
    def forward(self) -> Irradiance | None:
        """Light that the media only scatter forwards, by itself; `textures` have it, too."""

    @property
    def textures(self) -> LatticeTextures:
        """The textures that surfaces read: all light, with that of the media."""
