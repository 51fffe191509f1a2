"""The scheme that the settings choose, for the solver of a medium."""

from __future__ import annotations

from .delta.beams import DeltaBeams
from .delta.emission import Emission
from .grids.scheme import OrdinateGrids
from .settings import PopSettings
from .transport import Transport


def scheme_of(
    emission: Emission, settings: PopSettings, capacity: int, around: Transport | None
) -> Transport:
    """How the light of up to `capacity` ordinates spreads in the medium of `emission`.

    `around`: of a finer grid, the light of the next larger one.
    """
    medium = emission.medium
    # Grids per ordinate know neither other media nor nested grids.
    if settings.scheme != "delta-beam":
        return OrdinateGrids(medium, settings, capacity)
    assert around is None or isinstance(around, DeltaBeams)
    return DeltaBeams(
        medium,
        settings,
        capacity,
        medium.mixture,
        indirect=emission.indirect,
        takes_others=True,
        outer=around,
    )
