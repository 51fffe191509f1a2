"""Which techniques light surfaces by beams that volumes only scatter forwards."""

from __future__ import annotations

from ..fields import Solver
from ..lighting.kit import Kit
from ..pop.settings import PopSettings
from ..scatter.forward_beams import ForwardBeams, ForwardSolver
from .settings import PopTechniqueSettings


def forward_beams(
    kit: Kit, settings: PopSettings, *, is_paper: bool = False
) -> ForwardBeams | None:
    """Those for the lattices of a technique, where there are surfaces and the parts know them.

    Schemes of hops know no reduced medium, `is_paper` lattices are as printed, and what lies beyond
    lattices in an endless medium has beams of its own.
    """
    return ForwardBeams(kit) if _has_any(kit, settings) and not is_paper else None


def forward_solvers(kit: Kit, settings: PopTechniqueSettings) -> list[Solver]:
    """A solver of them, where every medium is on a grid of its own and no lattice is solved.

    The sky's light on surfaces knows media only where it is gathered; so do its beams.
    """
    if not _has_any(kit, settings):
        return []
    return [ForwardSolver(ForwardBeams(kit, has_solved_medium=True, sky=settings.gather))]


def _has_any(kit: Kit, settings: PopSettings) -> bool:
    scene = kit.context.scene
    is_endless = scene.medium is not None and scene.medium.endless
    return bool(scene.meshes) and settings.scheme == "delta-beam" and not is_endless
