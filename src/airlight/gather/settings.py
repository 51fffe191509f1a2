"""The settings of the final gather."""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.settings import setting

WHEN = ("off", "still", "always")


@dataclass(frozen=True)
class GatherSettings:
    """The settings of the final gather."""

    gather: str = setting(
        "still",
        "where surfaces gather their indirect light along rays, with the lattice for what the rays "
        "meet: nowhere, in images of several samples, or in frames of one too",
        choices=WHEN,
    )
    gather_rays: int = setting(
        8, "rays of a gather point in a sample of the image", low=1, high=1024
    )
    gather_guided: int = setting(
        1,
        "rays of a point beside these that are led to what lights shine on, where that is small; "
        "0: none are, nor those of later bounces and of cells of media",
        low=0,
        high=1024,
    )
    gather_bounces: int = setting(
        3, "bounces that they follow before the lattice is asked", low=1, high=16
    )
    gather_history: int = setting(
        0,
        "frames before a moving one whose gathered light it goes on from, where gather is always; "
        "0: a frame depends on no other",
        low=0,
        high=1024,
    )
    gather_air: int = setting(
        6,
        "rays that a cell of a lattice of media sends in a sample of a gathered image, in the mean "
        "and more near the eye, for the light that media scatter more than once; 0: what lattices "
        "solved is drawn",
        low=0,
        high=256,
    )
