"""The settings of each technique: those of its parts, joined."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

from ..gather.settings import GatherSettings
from ..lighting.cascades import CascadeSettings
from ..lighting.kit import SurfaceSettings
from ..lpv.settings import LpvSettings
from ..media.rays import RESOLUTIONS
from ..media.settings import MediaSettings
from ..pop.settings import PopSettings
from ..scatter.settings import ScatterSettings
from ..scene.settings import setting

_S = TypeVar("_S")


@dataclass(frozen=True)
class SingleSettings(SurfaceSettings, MediaSettings):
    """Settings of surfaces and of drawing media."""


@dataclass(frozen=True)
class LpvTechniqueSettings(LpvSettings, GatherSettings):
    """Settings of light propagation volumes on surfaces, and of the final gather."""


@dataclass(frozen=True)
class LpvMarchSettings(LpvSettings, MediaSettings):
    """Settings of light propagation volumes and of drawing media."""


@dataclass(frozen=True)
class LpvScatterSettings(CascadeSettings, ScatterSettings, MediaSettings, GatherSettings):
    """Settings of multiple scattering on nested lattices and of drawing media."""

    occlusion: bool = setting(True, "whether surfaces block and reflect propagating light")
    blockers: str = setting(
        "surfels",
        "where blockers come from: samples of all surfaces, or what six maps around the "
        "scene see, as in the paper",
        choices=("surfels", "maps"),
    )
    blocker_resolution: int = setting(256, "side of those maps", unit="px", low=8, high=4096)


@dataclass(frozen=True)
class PopTechniqueSettings(SurfaceSettings, PopSettings, GatherSettings):
    """Settings of surfaces and of principal ordinates."""

    march: str = setting("half", "resolution of the marched image", choices=tuple(RESOLUTIONS))
    march_steps: int = setting(128, "most steps of a view ray", low=8, high=1024)
    virtual_lights: int = setting(
        64,
        "virtual point lights on lit surfaces, for one bounce into media; 0: none",
        low=0,
        high=512,
    )


@dataclass(frozen=True)
class LpvWithPopSettings(LpvMarchSettings, PopSettings, GatherSettings):
    """Settings of `lpv`, which keep their names, and of principal ordinates."""


@dataclass(frozen=True)
class LpvScatterWithPopSettings(LpvScatterSettings, PopSettings):
    """Settings of `lpv-scatter`, which keep their names, and of principal ordinates."""


@dataclass(frozen=True)
class AutoSettings(SurfaceSettings, GatherSettings):
    """Settings of `auto` whatever it chooses; `settings_class` has all of them for a scene."""


def part_of(settings: Any, kind: type[_S], *, but: type | None = None) -> _S:
    """The settings of one part out of joined ones, without those that belong to `but`."""
    # A setting that both have is the other part's.
    taken = but.__dataclass_fields__.keys() if but else ()  # type: ignore[attr-defined]
    names = [name for name in kind.__dataclass_fields__ if name not in taken]  # type: ignore[attr-defined]
    return kind(**{name: getattr(settings, name) for name in names})
