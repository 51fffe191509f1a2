"""Several media in one frame: they shade one another, and each receives what the others scatter.

First every medium is solved under the light of the scene, attenuated by the others; then again, in
turn, with the light that the others scatter as they are solved by then.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..gpu.commands import Commands
from ..scene.volume import Volume
from .light.illumination import Illumination
from .solver import PopSolver

ROUNDS = 1
"""How often each medium receives the light of the others; in turn, so later ones see more of it."""


def introduce(solvers: Sequence[PopSolver]) -> None:
    """Set the other media of each; all were made with `others` of their number."""
    for solver in solvers:
        solver.medium.meet([other.medium for other in solvers if other is not solver])


def encode(
    commands: Commands,
    solvers: Sequence[PopSolver],
    volumes: Sequence[Sequence[Volume]],
    lit: Illumination,
) -> None:
    """Bring the emission of all up to date, each with its volume as it is in this frame."""
    # Ordinates and densities; where one medium changes, so does the mixture of all.
    changed = [
        solver.begin(commands, lit, volume) for solver, volume in zip(solvers, volumes, strict=True)
    ]
    is_new_medium = any(changed)
    if is_new_medium:
        for solver in solvers:
            solver.encode_medium(commands, lit)
    # The light of the scene in each medium, then the light of the others in each.
    is_new_light = any([solver.is_new_light(lit) for solver in solvers]) or is_new_medium
    if is_new_light:
        for solver in solvers:
            solver.encode_light(commands, lit)
        for _ in range(ROUNDS):
            for solver in solvers:
                solver.transport.encode_others(commands)
    # Radiance towards the eye.
    for solver in solvers:
        solver.encode_view(commands, lit, is_new_medium=is_new_medium, is_new_light=is_new_light)
        solver.encode_finer(commands, lit, is_new_light=is_new_light)
