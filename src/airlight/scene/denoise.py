"""The noise of gathered light, removed by Intel's Open Image Denoise.

The package pyoidn, of the extra `denoise`, brings the library. It looks at albedo and normals, too,
so that edges and textures stay.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

import numpy as np

from ..errors import SettingsError
from .checks import F32
from .image import Image

GATHERED = ("indirect", "multiple_scatter")
"""The layers that rays bring. Others are drawn without noise: the filter would only soften them."""


def denoised(image: Image) -> Image:
    """`image` with noise removed from its gathered layers, and from the whole by as much.

    An image without such layers is denoised as a whole. Pixels that are not finite count as black.
    Raises SettingsError where pyoidn is not installed or cannot be used here.
    """
    # What the filter knows of the surfaces, of which noise is none.
    guides = {name: image.layers[name] for name in ("albedo", "normal") if name in image.layers}
    if "albedo" not in guides:
        guides = {}  # the filter takes normals beside albedo alone
    light = {name: image.layers[name] for name in GATHERED if name in image.layers}
    if not light and "direct" in image.layers:
        return image  # nothing was gathered
    # Without layers there is but the whole to filter.
    if not light:
        return _with(image, _filtered(image.radiance, guides), {})
    # The image changes by what its gathered layers lost, so that the layers still add up to it.
    made = {name: _filtered(values, guides) for name, values in light.items()}
    change = sum(made[name] - _finite(values) for name, values in light.items())
    return _with(image, np.maximum(_finite(image.radiance) + change, 0.0), made)


def denoiser() -> Callable[..., F32]:
    """The library's function. Raises SettingsError where it is not there or cannot be loaded."""
    try:
        from pyoidn import denoise
    except (ImportError, OSError, AttributeError) as error:
        raise SettingsError(
            f"denoising needs Open Image Denoise ({error})",
            remedy="Run: pip install 'airlight[denoise]'.",
        ) from error
    return cast(Callable[..., F32], denoise)


def _with(image: Image, radiance: F32, layers: dict[str, F32]) -> Image:
    light = np.asarray(radiance, np.float32)
    return replace(image, radiance=light, layers={**image.layers, **layers})


def _filtered(light: F32, guides: dict[str, F32]) -> F32:
    """Light (H, W, 3) without its noise; black stays as it is."""
    denoise = denoiser()
    if not light.any():
        return light
    try:
        finite = {name: _finite(values) for name, values in guides.items()}
        return np.asarray(denoise(_finite(light), **finite, hdr=True))
    except RuntimeError as error:
        raise SettingsError(f"Open Image Denoise does not work here: {error}") from error


def _finite(values: F32) -> F32:
    """Contiguous float32, 0 where a value is NaN or infinite."""
    return np.ascontiguousarray(np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0), np.float32)
