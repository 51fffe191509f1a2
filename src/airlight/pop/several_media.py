"""Several media in one lit: they shade one another, and each is lit by what the others scatter.

First every medium is solved under the light of the scene, through the others; then again, in turn,
with what the others send out as they are solved by then.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..gpu.commands import Commands
from ..scene.volume import Volume
from .solver import Illumination, PopSolver

ROUNDS = 1
"""How often light is handed on between media, beyond what the turns themselves hand on."""


def introduce(solvers: Sequence[PopSolver]) -> None:
    """Tell each of the others; all were made with `others` of their number."""
    for solver in solvers:
        solver.medium.meet([other.medium for other in solvers if other is not solver])


def encode(
    commands: Commands, solvers: Sequence[PopSolver], volumes: Sequence[Volume], lit: Illumination
) -> None:
    """Bring the emission of all up to date, each with its volume as it is now."""
    changed = [
        solver.begin(commands, lit, volume) for solver, volume in zip(solvers, volumes, strict=True)
    ]
    new_medium = any(changed)
    if new_medium:
        for solver in solvers:
            solver.encode_medium(commands, lit)
    new_light = any([solver.is_new_light(lit) for solver in solvers]) or new_medium
    if new_light:
        for solver in solvers:
            solver.encode_light(commands, lit)
        for _ in range(ROUNDS):
            for solver in solvers:
                solver.beams.encode_given(commands)
    for solver in solvers:
        solver.encode_view(commands, lit, new_medium=new_medium, new_light=new_light)
