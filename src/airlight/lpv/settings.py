"""The settings of light propagation volumes."""

from __future__ import annotations

from dataclasses import dataclass

from ..lighting.cascades import CascadeSettings
from ..scene.settings import setting
from .storage import STORAGES

SOURCES = ("meshes", "views", "both")
"""Where surfels come from."""


@dataclass(frozen=True)
class LpvSettings(CascadeSettings):
    """The settings of light propagation volumes."""

    scheme: str = setting("centroid", "how a hop keeps direction", choices=("centroid", "paper"))
    iterations: int = setting(0, "propagation steps; 0: 2 a cell, at least 64", low=0, high=1024)
    tail: bool = setting(
        True, "whether what all later steps would add is estimated, from 32 iterations on"
    )
    storage: str = setting("float32", "how lattices are stored between steps", choices=STORAGES)
    map_resolution: int = setting(
        256,
        "side of reflective shadow maps; directional lights' are drawn at twice that",
        unit="px",
        low=8,
        high=4096,
    )
    surfel_source: str = setting("meshes", "what blockers are sampled from", choices=SOURCES)
    surfel_resolution: int = setting(
        128, "side of the views that blockers are taken from", unit="px", low=8, high=2048
    )
    peel_layers: int = setting(2, "depth layers of each of them", low=1, high=8)
    keep_surfels: bool = setting(True, "whether what views saw before still blocks, until it moves")
    occlusion: bool = setting(True, "whether surfaces stop propagating light")
    bounces: bool = setting(True, "whether stopped light bounces on, beyond the first bounce")
    small_objects: str = setting(
        "moving",
        "objects smaller than a cell that larger cascades leave out",
        choices=("moving", "all", "none"),
    )
    damping: float = setting(
        0.0,
        "how strongly light that falls off away from a surface is taken for a leak",
        low=0,
        high=10,
    )
