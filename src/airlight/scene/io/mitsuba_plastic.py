"""What Mitsuba's plastics reflect diffusely, as the albedo of a Lambert surface under our coat.

Light passes the coat twice. Under a smooth coat that is as here, unless it is told to be lost again
inside ("nonlinear"); a rough coat lets less of it through in Mitsuba, down to a third.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...maths.colour import srgb_decode, srgb_encode
from ...maths.transforms import triple
from ..checks import F64, Rgb
from ..material import Texture

_INDICES = (1.1, 1.33, 1.5, 1.8, 2.2)
_ALPHAS = (0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)
# By index and alpha: what of a white base comes out of Mitsuba 3.9's `roughplastic`, over what
# comes out of its `plastic`; seen at .5 rad, integrated over the light's direction.
_OUT = {
    "ggx": (
        (0.997, 0.984, 0.958, 0.898, 0.846, 0.801, 0.723, 0.656, 0.594),
        (0.985, 0.967, 0.926, 0.828, 0.738, 0.665, 0.554, 0.472, 0.406),
        (0.977, 0.954, 0.904, 0.785, 0.678, 0.593, 0.471, 0.386, 0.321),
        (0.963, 0.931, 0.864, 0.713, 0.587, 0.492, 0.364, 0.282, 0.224),
        (0.937, 0.885, 0.796, 0.613, 0.476, 0.381, 0.263, 0.193, 0.147),
    ),
    "beckmann": (
        (0.997, 0.996, 0.989, 0.962, 0.927, 0.896, 0.846, 0.805, 0.769),
        (0.985, 0.983, 0.975, 0.942, 0.890, 0.831, 0.724, 0.645, 0.585),
        (0.978, 0.975, 0.965, 0.925, 0.866, 0.796, 0.667, 0.571, 0.501),
        (0.964, 0.960, 0.946, 0.894, 0.819, 0.737, 0.586, 0.474, 0.395),
        (0.941, 0.926, 0.906, 0.836, 0.744, 0.650, 0.485, 0.370, 0.293),
    ),
}
# Likewise: the share of diffuse light that its coat throws back inside.
_BACK = {
    "ggx": (
        (0.191, 0.179, 0.157, 0.112, 0.078, 0.054, 0.029, 0.016, 0.010),
        (0.464, 0.453, 0.428, 0.364, 0.298, 0.241, 0.157, 0.104, 0.070),
        (0.587, 0.576, 0.552, 0.486, 0.415, 0.348, 0.241, 0.167, 0.117),
        (0.722, 0.712, 0.689, 0.625, 0.551, 0.478, 0.350, 0.254, 0.185),
        (0.822, 0.811, 0.790, 0.728, 0.654, 0.579, 0.440, 0.330, 0.246),
    ),
    "beckmann": (
        (0.191, 0.189, 0.183, 0.158, 0.125, 0.096, 0.058, 0.036, 0.024),
        (0.465, 0.463, 0.458, 0.436, 0.402, 0.359, 0.270, 0.199, 0.146),
        (0.588, 0.586, 0.581, 0.561, 0.530, 0.489, 0.394, 0.305, 0.234),
        (0.723, 0.721, 0.717, 0.699, 0.671, 0.634, 0.542, 0.443, 0.354),
        (0.823, 0.820, 0.815, 0.799, 0.774, 0.741, 0.654, 0.553, 0.455),
    ),
}


def coated(
    color: Rgb,
    texture: Texture | None,
    *,
    index: float,
    alpha: float,
    distribution: str = "beckmann",
    is_nonlinear: bool = False,
) -> tuple[Rgb, Texture | None]:
    """The factor and the image of what is reflected diffusely under a coat of a relative `index`.

    `alpha`: how rough the coat is, 0 where it is smooth.
    """
    tables = (_OUT, _BACK)
    out, back = (_looked_up(t.get(distribution, t["ggx"]), index, alpha) for t in tables)
    out = 1.0 if alpha == 0.0 else out
    # Lost again and again inside, a colour becomes darker and more saturated.
    if texture is None or not is_nonlinear:
        factor = np.array(color) * out
        if is_nonlinear:
            factor *= (1.0 - back) / (1.0 - back * np.array(color))
        return triple(factor), texture
    # So does each texel, which holds the factor then.
    decoded = np.arange(256) / 255.0
    decoded = np.asarray(srgb_decode(decoded)) if texture.is_srgb else decoded
    pixels = texture.pixels.copy()
    for channel, share in enumerate(color):
        base = share * decoded
        found = base * out * (1.0 - back) / (1.0 - back * base)
        encoded = np.asarray(srgb_encode(found)) if texture.is_srgb else found
        table = np.round(255.0 * np.clip(encoded, 0.0, 1.0)).astype(np.uint8)
        pixels[..., channel] = table[pixels[..., channel]]
    return (1.0, 1.0, 1.0), replace(texture, pixels=pixels)


def mean_alpha(rough: Mapping[str, Any]) -> float:
    """Mitsuba's alpha, on the average of an image of it, of a Material's fields of roughness."""
    image = rough.get("metallic_roughness_texture")
    mean = 1.0 if image is None else float(((image.pixels[..., 1] / 255.0) ** 2).mean())
    return float(rough["roughness"]) ** 2 * mean


def _looked_up(table: tuple[tuple[float, ...], ...], index: float, alpha: float) -> float:
    """Linear between the table's entries, the nearest one beyond its ends."""
    by_index: F64 = np.array([np.interp(alpha, _ALPHAS, row) for row in table])
    return float(np.interp(index, _INDICES, by_index))
