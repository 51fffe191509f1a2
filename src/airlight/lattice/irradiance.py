"""The field that surfaces read: irradiance of solved lattices and of the sky."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..gpu.memory import Texture


@dataclass(frozen=True, eq=False)
class Irradiance:
    """Indirect light at a point with a normal, W m^-2, from the cells around it.

    `bound`: by slot name the table `lattices` and the textures of their states. `is_reflected`:
    surfaces reflected this light, so that near surfaces send more of it than cells resolve.
    `has_interreflection`: it bounces on between near surfaces. `damping`: how strongly light that
    falls off away from a surface counts as a leak.
    """

    bound: Mapping[str, Any]
    is_reflected: bool = False
    has_interreflection: bool = True
    damping: float = 0.0


@dataclass(frozen=True, eq=False)
class SkyIrradiance:
    """The environment's direct light in every cell, W m^-2, as ambient cubes (McTaggart2004)."""

    cube: Texture
