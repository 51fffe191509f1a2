"""Settings of drawing participating media."""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.settings import setting
from .rays import RESOLUTIONS


@dataclass(frozen=True)
class MediaSettings:
    """How single scattering and marching are done."""

    shafts: str = setting(
        "auto",
        "how single scattering finds its shadows; auto: minmax; volumes: light volumes, as in "
        "the paper, for one homogeneous box; jitter: the cheap one, of much noise",
        choices=("auto", "minmax", "volumes", "jitter", "off"),
    )
    volume_tolerance: float = setting(
        0.5,
        "how far facets of light volumes may lie off the shadow map",
        unit="texels",
        low=0.0,
        high=16.0,
    )
    shaft_resolution: str = setting("half", "of single scattering", choices=tuple(RESOLUTIONS))
    shaft_contrast: float = setting(
        0.1,
        "between the texels of reduced single scattering that a pixel is made of, beyond which "
        "it is redrawn; 0: everywhere, 1: nowhere; below 1 also everywhere where texels are so "
        "coarse, in small images, that shafts fit between them",
        low=0.0,
        high=1.0,
    )
    shaft_steps: int = setting(
        32,
        "steps of a ray in the jittered scheme, and of its paths through density grids in "
        "minmax, which are never shorter than voxels",
        low=1,
        high=1024,
    )
    shaft_nodes: int = setting(
        256, "squares of a shadow map that one ray may visit", low=16, high=65536
    )
    march_resolution: str = setting("half", "of marching", choices=tuple(RESOLUTIONS))
    march_steps: int = setting(128, "most steps of a ray", low=1, high=4096)
    steps_per_cell: float = setting(1.0, "steps per cell of the finest source", low=0.1, high=16)
    column_resolution: int = setting(
        48,
        "texels along a density grid's light columns; up to three times as many where matter is so "
        "dense that light ends within one",
        low=2,
        high=512,
    )
