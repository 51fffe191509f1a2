"""Where virtual point lights are sampled from."""

from __future__ import annotations

from dataclasses import dataclass

from ...lattice.blockers import Blockers
from ...lattice.placement import Placement
from ...surface.reflective import ReflectiveShadowMaps


@dataclass(eq=False)
class ReflectedLights:
    """Reflective shadow maps, the blockers between them and media, and how many samples to take.

    `placement`: of the lattice of the `blockers`. `version`: another one whenever a map changed.
    """

    maps: tuple[ReflectiveShadowMaps, ...]
    blockers: Blockers
    placement: Placement
    count: int
    version: int = 0
