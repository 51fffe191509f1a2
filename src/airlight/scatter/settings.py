"""What multiple scattering can be told, and what the scene's media ask of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import SettingsError
from ..lattice.placement import Placement
from ..maths.transforms import box_along
from ..media.reduced import reduced_scene
from ..scene.checks import Rgb
from ..scene.medium import medium_box
from ..scene.scene import Scene
from ..scene.settings import setting
from .coefficients import check_depth
from .schedule import ACCELERATIONS, FORMER_ACCELERATIONS

SCHEMES = ("auto", "deposit", "half-linear", "paper", "paper-gamma")


@dataclass(frozen=True)
class ScatterSettings:
    """What multiple scattering on a lattice can be told."""

    scheme: str = setting(
        "auto",
        "how a hop scatters; auto: deposit, or half-linear where the medium varies; paper: "
        "eq. 3 as printed; paper-gamma: with what it loses put back",
        choices=SCHEMES,
    )
    iterations: int = setting(
        24,
        "propagation steps",
        low=0,
        high=512,
    )
    still_iterations: int = setting(
        48,
        "those of images of several samples, unless iterations or residual are set",
        low=1,
        high=512,
    )
    residual: float = setting(
        0.0,
        "light that may still be under way; chooses the iterations where above 0",
        low=0.0,
        high=0.9,
    )
    acceleration: str = setting(
        "regions",
        "for slow light: none, or regions of the lattice, between which it is brought at once",
        choices=ACCELERATIONS,
        former=FORMER_ACCELERATIONS,
    )
    occlusion: bool = setting(True, "whether surfaces stop and reflect propagating light")
    single: str = setting(
        "gather",
        "how first-scattered light comes into cells: gathered by them, or from points "
        "of every map texel's ray; off: what surfaces reflect alone",
        choices=("gather", "random", "stratified", "off"),
    )
    samples: int = setting(8, "points of a map texel's ray", low=1, high=64)
    seed: int = setting(0, "of random points", low=0)
    map_resolution: int = setting(
        256,
        "side of reflective shadow maps; directional lights' are drawn at twice that",
        unit="px",
        low=8,
        high=4096,
    )


def iterations_of(settings: ScatterSettings, *, is_still: bool) -> int:
    """How many iterations there are: in stills more, where nobody says how many."""
    # A number that was set counts for moving frames and stills alike.
    is_asked = settings.iterations != ScatterSettings.iterations or settings.residual > 0.0
    return settings.still_iterations if is_still and not is_asked else settings.iterations


def is_varied(scene: Scene, placement: Placement, settings: ScatterSettings) -> bool:
    """Whether cells need coefficients of their own.

    Raises SettingsError where the scheme has none, or eq. 3 as printed is unstable.
    """
    # A volume, or a medium that ends within the lattice, differs from cell to cell.
    varies = bool(scene.volumes)
    medium = scene.medium
    if medium is not None and (medium.bounds is not None or medium.endless):
        low, high = medium_box(medium, *scene.bounds, scene.camera.position)
        # A lattice reaches up to two and a half cells further than what it is fitted to
        # (`at_walls`); that far inside it a medium may end, as one without bounds does.
        inner = placement.cell * 2.5
        first, last = placement.bounds
        least, most = box_along(np.array(placement.axes).T, first + inner, last - inner)
        varies = varies or bool((least < low).any() or (most > high).any())
    if varies and settings.scheme == "deposit":
        raise SettingsError(
            f"scheme = '{settings.scheme}' knows only one medium that fills the lattice",
            remedy="Use scheme = 'auto', or leave out volumes and the medium's bounds.",
        )
    if varies and settings.scheme.startswith("paper"):
        check_depth(densest_medium(reduced_scene(scene))[1], placement.cell)
    return varies or settings.scheme == "half-linear"


def densest_medium(scene: Scene) -> tuple[Rgb, Rgb]:
    """(sigma_s, sigma_t), m^-1, of the scene's densest medium; zero without any."""
    found: list[tuple[Rgb, Rgb]] = []
    if scene.medium:
        found.append((scene.medium.sigma_s, scene.medium.sigma_t))
    # A volume counts by its densest voxel.
    for volume in scene.volumes:
        peak = 1.0 if volume.density is None else float(volume.density.max())
        r, g, b = (peak * t for t in volume.sigma_t)
        x, y, z = volume.albedo
        found.append(((r * x, g * y, b * z), (r, g, b)))
    nothing = (0.0, 0.0, 0.0)
    return max(found, key=lambda pair: max(pair[1]), default=(nothing, nothing))
