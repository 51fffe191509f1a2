"""What surfaces read of solved lattices: the field between solvers and the lighting of pixels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..gpu.memory import Texture


@dataclass(frozen=True, eq=False)
class Irradiance:
    """Indirect light at a point with a normal, W m^-2, from the cells around it.

    `bound`: by slot name the table `lattices` and the textures of their states. `is_bounced`:
    whether it is light that surfaces reflected, of which near surfaces send more than cells
    resolve; `is_bouncing`: whether that bounces on between them. `damping`: how strongly light
    that falls off away from a surface is taken for a leak.
    """

    bound: Mapping[str, Any]
    is_bounced: bool = False
    is_bouncing: bool = True
    damping: float = 0.0


@dataclass(frozen=True, eq=False)
class SkyIrradiance:
    """The environment's direct light in every cell, W m^-2, as ambient cubes (McTaggart2004).

    `version` changes whenever `cube` does.
    """

    cube: Texture
    version: int
