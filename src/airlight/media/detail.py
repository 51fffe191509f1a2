"""Noise finer than the voxels of a density grid, as its eddies would look.

The density is multiplied by exp(a n + b): n is a fractal noise of mean 0 and deviation 1 that
repeats every 16 voxels, a the `detail` of the volume, and b makes the mean exactly 1, so that a
volume keeps its mass and no density is negative. Elek2014 section 7 enhances its grids so.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..maths.transforms import F64
from ..scene.builtin.noise import fractal_noise
from ..scene.checks import F32
from ..scene.volume import Volume

TEXELS = 64
"""Texels of the noise along each axis."""
VOXELS = 16
"""Voxels of the grid after which the noise repeats."""
_CELLS = 8  # the coarsest noise: two voxels
# Any: noise has to be the same in each image.
_SEED = 23


@lru_cache(maxsize=1)
def detail_noise() -> F32:
    """The noise n (z, y, x)."""
    rng = np.random.default_rng(_SEED)
    return fractal_noise((TEXELS,) * 3, (_CELLS,) * 3, rng, octaves=3, gain=0.6)


def detail_texture(gpu: Gpu) -> Texture:
    """The noise on the device."""
    made = Texture(gpu, "detail", (TEXELS,) * 3, "r16float", dimension="3d")
    made.write(detail_noise().astype(np.float16))
    return made


@lru_cache(maxsize=16)
def detail_bias(amplitude: float) -> float:
    """b: minus the logarithm of the mean of exp(amplitude n)."""
    # Exponents are at most 0, so that none overflows.
    n = amplitude * detail_noise().astype(np.float64)
    top = float(n.max())
    return -top - float(np.log(np.exp(n - top).mean()))


def detail_periods(volume: Volume) -> F64:
    """How often the noise repeats over a volume's box along x, y, z."""
    assert volume.density is not None
    return np.array(volume.density.shape[::-1]) / VOXELS
