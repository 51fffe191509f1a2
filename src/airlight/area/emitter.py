"""A group of what gives light, as surfaces see it: an analytic shape, and samples on it."""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.lights import LightSample, SpotLight
from .segments import Segment
from .shapes import Shape


@dataclass(frozen=True, eq=False)
class Sample:
    """One point of an emitter. `near`, m: what is nearer does not shadow it.

    `segment`: what its part of the surface is as long as, where that is long and thin.
    """

    light: LightSample
    near: float
    is_cube: bool
    segment: Segment | None = None


@dataclass(frozen=True, eq=False)
class Emitter:
    """A group of pieces: its analytic shape, its samples, and how its light fades (spots).

    `row`: of the first of the lights that stand for it in the scene's table, `row_count` of them,
    for the transmittance of media. `is_outlined`: its polygon's outline is that of the surface that
    is seen, which glows alike all over. `is_medium`: it is a part of a medium that glows.
    """

    shape: Shape
    samples: tuple[Sample, ...]
    row: int
    row_count: int = 1
    spot: SpotLight | None = None
    is_outlined: bool = False
    is_medium: bool = False
