"""Participating media: extinction, albedo and phase function."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import SceneError
from . import checks
from .checks import F64, Bounds, Rgb

FILL_MARGIN = 1e-3
"""Of the diagonal: a medium that fills a scene ends outside its walls."""
_ABOVE = 0.25
"""Of a scene's height: how far an endless medium reaches above it."""
_OPAQUE = 14.0
"""Optical depths of which a millionth of the light comes through: as good as endless."""
_HORIZON = 2000.0
"""How many times as far as an eye is above the fog its horizon is: less than a pixel down."""
_FARTHEST_M = 1e5
"""Beyond it single precision no longer tells centimetres apart."""


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium.

    `sigma_t` extinction in m^-1, `albedo` = sigma_s/sigma_t in [0, 1], `g` the mean cosine of
    the Henyey-Greenstein phase function in (-1, 1), each per RGB channel. Without `bounds`
    (metres) it fills the scene's bounds, the camera included. An `endless` one goes on sideways and
    downwards without an end, below the height `top` (metres; by default the scene's top and a
    quarter of its height above that): fog without a top would let no sun in. `emission` is the
    light that it gives off itself, W m^-3 sr^-1.
    """

    sigma_t: Rgb
    albedo: Rgb = (1.0, 1.0, 1.0)
    g: Rgb = (0.0, 0.0, 0.0)
    bounds: Bounds | None = None
    endless: bool = False
    top: float | None = None
    emission: Rgb = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "sigma_t", checks.rgb(self.sigma_t, "sigma_t"))
        put(self, "albedo", checks.rgb(self.albedo, "albedo", high=1.0))
        put(self, "g", mean_cosine(self.g))
        put(self, "emission", checks.rgb(self.emission, "emission"))
        # Bounds and an endless medium contradict each other; a top belongs to an endless one.
        if self.bounds is not None:
            put(self, "bounds", checks.bounds(self.bounds, "medium bounds"))
            if self.endless:
                raise SceneError("an endless medium has no bounds", remedy="Give its top alone.")
        if self.top is not None:
            put(self, "top", checks.number(self.top, "top"))
            if not self.endless:
                raise SceneError("only an endless medium has a top", remedy="Add endless = true.")

    @property
    def sigma_s(self) -> Rgb:
        """Scattering coefficient, m^-1."""
        r, g, b = (a * t for a, t in zip(self.albedo, self.sigma_t, strict=True))
        return (r, g, b)

    @property
    def sigma_a(self) -> Rgb:
        """Absorption coefficient, m^-1."""
        r, g, b = ((1.0 - a) * t for a, t in zip(self.albedo, self.sigma_t, strict=True))
        return (r, g, b)


def mean_cosine(value: Any) -> Rgb:
    """g per channel, each in (-1, 1)."""
    grey = isinstance(value, (int, float)) and not isinstance(value, bool)
    g = checks.vec3([value] * 3 if grey else value, "g")
    if not all(-1.0 < c < 1.0 for c in g):
        raise SceneError(f"g = {list(g)} must lie in (-1, 1)")
    return g


def extinction_and_albedo(sigma_s: Any, sigma_a: Any) -> tuple[Rgb, Rgb]:
    """(sigma_t, albedo) from scattering and absorption, m^-1."""
    s, a = checks.rgb(sigma_s, "sigma_s"), checks.rgb(sigma_a, "sigma_a")
    t = (s[0] + a[0], s[1] + a[1], s[2] + a[2])
    # Where nothing is, the albedo does not matter.
    w = tuple(x / y if y > 0.0 else 0.0 for x, y in zip(s, t, strict=True))
    return t, (w[0], w[1], w[2])


def filled_box(low: Any, high: Any, eye: Any) -> tuple[F64, F64]:
    """What a medium without bounds fills: the scene's box low..high and the eye, metres."""
    # The margin keeps walls that bound the scene inside of the medium.
    low, high = np.minimum(low, eye), np.maximum(high, eye)
    margin = FILL_MARGIN * float(np.linalg.norm(high - low)) + 1e-6
    return low - margin, high + margin


def medium_box(medium: Medium, low: Any, high: Any, eye: Any) -> tuple[F64, F64]:
    """The box that a medium fills in a scene of the box low..high seen from `eye`, metres.

    An endless medium has one so large that nothing is seen of its sides.
    """
    if medium.bounds is not None:
        return np.array(medium.bounds[0]), np.array(medium.bounds[1])
    if not medium.endless:
        return filled_box(low, high, eye)
    # Fog ends a quarter of the scene's height above it, unless its top is said.
    top = medium.top
    if top is None:
        top = float(high[1] + _ABOVE * (high[1] - low[1]))
    # So far that the border is behind opaque fog, or below the horizon seen from above.
    thinnest = min((c for c in medium.sigma_t if c > 0.0), default=1.0)
    aside = float(np.linalg.norm(np.subtract(high, low)) + np.linalg.norm(np.subtract(eye, low)))
    reach = _OPAQUE / thinnest + aside + _HORIZON * max(0.0, float(eye[1]) - top)
    # In powers of two, so that it stays the same box while the eye moves.
    reach = 2.0 ** np.ceil(np.log2(min(reach, _FARTHEST_M)))
    low, high = np.subtract(low, reach), np.add(high, reach)
    low[1], high[1] = min(low[1], top - reach), top
    return low, high
