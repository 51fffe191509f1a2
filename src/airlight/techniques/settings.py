"""What each technique can be told: the settings of its parts, joined."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

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
    """Surfaces, and how media are drawn."""


@dataclass(frozen=True)
class LpvMarchSettings(LpvSettings, MediaSettings):
    """Light propagation volumes, and how media are drawn."""


@dataclass(frozen=True)
class LpvScatterSettings(SurfaceSettings, ScatterSettings, MediaSettings):
    """Multiple scattering on a lattice, and how media are drawn."""

    occlusion: bool = setting(True, "whether surfaces stop and reflect propagating light")
    blockers: str = setting(
        "surfels",
        "what is known of surfaces that stop light: samples of all of them, or what six "
        "maps around the scene see, as in the paper",
        choices=("surfels", "maps"),
    )
    blocker_resolution: int = setting(256, "side of those maps", unit="px", low=8, high=4096)


@dataclass(frozen=True)
class PopTechniqueSettings(SurfaceSettings, PopSettings):
    """Surfaces, and principal ordinates."""

    march: str = setting("half", "resolution of the marched picture", choices=tuple(RESOLUTIONS))
    march_steps: int = setting(128, "most steps of a view ray", low=8, high=1024)
    virtual_lights: int = setting(
        64,
        "points of lit surfaces whose reflected light media see, once; 0: none",
        low=0,
        high=512,
    )


@dataclass(frozen=True)
class LpvWithPopSettings(LpvMarchSettings, PopSettings):
    """Bounced light on lattices, whose names these are first, and principal ordinates."""


@dataclass(frozen=True)
class LpvScatterWithPopSettings(LpvScatterSettings, PopSettings):
    """A scattering lattice, whose names these are first, and principal ordinates."""


@dataclass(frozen=True)
class AutoSettings(SurfaceSettings):
    """What `auto` can be told whatever it chooses; `settings_class` knows more for a scene."""


def part_of(settings: Any, kind: type[_S], *, but: type | None = None) -> _S:
    """The settings of one part among joined ones; those that `but` has mean its own."""
    taken = but.__dataclass_fields__.keys() if but else ()  # type: ignore[attr-defined]
    names = [name for name in kind.__dataclass_fields__ if name not in taken]  # type: ignore[attr-defined]
    return kind(**{name: getattr(settings, name) for name in names})
