"""What fills the air: extinction, albedo and phase function."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..errors import SceneError
from . import checks
from .checks import Bounds, Rgb


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium.

    `sigma_t` extinction in m^-1, `albedo` = sigma_s/sigma_t in [0, 1], `g` the mean cosine of
    the Henyey-Greenstein phase function in (-1, 1), each per RGB channel. Without `bounds`
    (metres) it fills the scene's bounds, the camera included.
    """

    sigma_t: Rgb
    albedo: Rgb = (1.0, 1.0, 1.0)
    g: Rgb = (0.0, 0.0, 0.0)
    bounds: Bounds | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "sigma_t", checks.rgb(self.sigma_t, "sigma_t"))
        put(self, "albedo", checks.rgb(self.albedo, "albedo", high=1.0))
        put(self, "g", mean_cosine(self.g))
        if self.bounds is not None:
            put(self, "bounds", checks.bounds(self.bounds, "medium bounds"))

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
    w = tuple(x / y if y > 0.0 else 0.0 for x, y in zip(s, t, strict=True))
    return t, (w[0], w[1], w[2])
