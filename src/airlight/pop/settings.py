"""Settings of principal-ordinates propagation."""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.settings import setting
from .light.importance import IMPORTANCE
from .light.ordinates import MAKERS

SCHEMES = ("delta-beam", "split", "paper")


@dataclass(frozen=True)
class PopSettings:
    """Settings of principal-ordinates propagation."""

    scheme: str = setting(
        "delta-beam",
        "how light spreads: beams and diffusion; hops, corrected; hops as printed, "
        "3 to 17 times too bright",
        choices=SCHEMES,
    )
    ordinates: int = setting(64, "directions that stand for the environment", low=1, high=512)
    ordinates_from: str = setting(
        "partition",
        "how a map becomes directions: parts of it, or samples of it as in the paper",
        choices=tuple(MAKERS),
    )
    importance: str = setting(
        "none",
        "where few directions are drawn to: the map's light alone, or what the camera sees "
        "of it, too",
        choices=IMPORTANCE,
    )
    grid: int = setting(
        20, "cells along a side of a cube-shaped medium; others get as many", low=4, high=64
    )
    grid_levels: int = setting(
        1,
        "nested grids of a medium that is alone (delta-beam), each finer than the one around it "
        "and ahead of the camera",
        low=1,
        high=4,
    )
    grid_ratio: float = setting(
        2.0, "how much larger the cells of the next grid are", low=1.25, high=8.0
    )
    iterations: int = setting(20, "most hops of light (split, paper)", low=1, high=400)
    residuum: bool = setting(True, "hand nearly isotropic light to one shared grid (paper)")
    residuum_iterations: int = setting(20, "hops of the shared grid (paper)", low=0, high=400)
    solver_steps: int = setting(36, "steps of the diffusion solve", low=1, high=512)
    prefilter: bool = setting(
        True,
        "spread each ordinate over its part of the sky; shows where the sky is not exact "
        "(exact_sky), or light scatters many times",
    )
    virtual_lights: int = setting(
        0,
        "points of lit surfaces whose reflected light media see, once; 0: the light of a "
        "lattice, where there is one",
        low=0,
        high=512,
    )
    virtual_grids: str = setting(
        "beams",
        "how the light of virtual lights spreads (delta-beam): as beams, or in hops on "
        "shells around each as in split and paper",
        choices=("beams", "radial"),
    )
    virtual_resolution: int = setting(
        256, "side of the maps that they are taken from", unit="px", low=8, high=4096
    )
    exact_sky: bool = setting(
        True,
        "whether the sky's light that scatters once is exact without a medium, however few "
        "directions stand for it",
    )
    furnace_correction: float = setting(
        1.0,
        "share of the error under a uniform sky that is taken off multiple scattering; 0: none",
        low=0.0,
        high=1.0,
    )


MOST_ALONE = 4
"""Media that are solved and marched on grids of their own; of more, those of a kind share one."""


def uses_virtual_grids(settings: PopSettings, *, alone: bool) -> bool:
    """Whether virtual point lights propagate in grids of their own instead of being beams.

    `alone`: whether a scene has no other medium; grids know one medium only.
    """
    return settings.scheme != "delta-beam" or (settings.virtual_grids == "radial" and alone)
