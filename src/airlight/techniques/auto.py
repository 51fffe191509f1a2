"""The technique `auto`: the recipe whose solvers suit a scene.

surfaces  no media: lpv; media: lpv-scatter, whose lattice carries bounced and scattered light
volumes   pop, a solver each for the light of suns, lamps and sky, marched as sources; light that
          surfaces reflect into them comes from the lattice, which they dim and add to
          (`volumes`). Part of the lattice's medium where there are more than four, or where a box
          or ball takes much of a lamp's light from the room: there single scattering is exact (a
          thick ball in the Cornell box: relative L2 error of its light .21, by pop .33; of density
          grids pop has the smaller error, .27 where the lattice's medium has .55)
"""

from __future__ import annotations

import numpy as np

from ..maths.transforms import F64
from ..scene.lights import DirectionalLight
from ..scene.scene import Scene, volume_world_bounds
from ..scene.volume import Volume

_MOST_SOLVED = 4  # volumes that can be marched as sources of their own
_SHADED_SHARE = 0.05


def recipe_for(scene: Scene) -> str:
    """The name of the recipe that `auto` takes for a scene."""
    if scene.medium is None and not scene.volumes:
        return "lpv"
    if not scene.volumes or len(scene.volumes) > _MOST_SOLVED or _shades_a_room(scene):
        return "lpv-scatter"
    return "lpv with pop" if scene.medium is None else "lpv-scatter with pop"


def _shades_a_room(scene: Scene) -> bool:
    """Whether a volume takes more than a few percent of the lamps' light from the surfaces.

    Density grids do not count where the lattice is lpv's: it knows them.
    """
    if all(isinstance(light, DirectionalLight) for light in scene.lights) or not scene.meshes:
        return False
    low, high = scene.bounds
    room = _section(high - low)
    is_even = [scene.medium is not None or v.density is None for v in scene.volumes]
    shapes = [volume for volume, even in zip(scene.volumes, is_even, strict=True) if even]
    return any(_shading(volume) > _SHADED_SHARE * room for volume in shapes)


def _shading(volume: Volume) -> float:
    """About how much a volume's box stops: its section, m^2, times the share it takes."""
    low, high = volume_world_bounds(volume)
    density = 1.0 if volume.density is None else float(volume.density.mean())
    depth = max(volume.sigma_t) * density * float(np.cbrt(np.prod(high - low)))
    return _section(high - low) * -float(np.expm1(-depth))


def _section(size: F64) -> float:
    """Mean area of a box's sides, m^2."""
    x, y, z = size
    return float(x * y + y * z + z * x) / 3.0
