"""Light propagation in the plane, beside its analytic truth (Kaplanyan2010 section 5, Fig. 5).

A lattice of N x N unit cells; a cell's intensity over the travel angle t is kept in circular
harmonics: row vectors (c0, c1 cos, c1 sin, c2 cos, ...) over the orthonormal basis of `basis`,
2 bands - 1 numbers. Arrays are (y, x, K). Lights are one-sided Lambertian segments on the low
borders. Schemes, by name:

paper    Kaplanyan2010 section 3.3: intensity towards each far face's centre, re-emitted as a cosine
         lobe along the face's normal
dom4     discrete ordinates from cell centre to the 4 axial neighbours (its modified DOM)
dom8     the same to all 8 neighbours (the standard DOM)
ray      as paper, re-emitted along the ray to the face's centre
centroid ours: received over the whole angle of each face, re-emitted with that angle's moments

Intensities below zero are cut where light leaves a cell, as the paper does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from ..errors import SettingsError, nearest
from ..maths.arrays import F64

SIDE_CELLS = 24
STEPS = 48
SCHEMES = ("paper", "dom4", "dom8", "ray", "centroid")
_FAR_HALF_ANGLE = float(np.arctan(1.0 / 3.0))  # of the far face, seen from the source's centre
_TO_SIDE_CENTRE = float(np.arctan2(0.5, 1.0))


@dataclass(frozen=True)
class Segment:
    """A light of unit radiance on the border x = 0 or y = 0, from `low` to `high` along it."""

    border: str
    low: int
    high: int

    @property
    def facing(self) -> float:
        """The angle of its normal."""
        return 0.0 if self.border == "x" else 0.5 * np.pi


ONE_LIGHT = (Segment("x", 6, 18),)
TWO_LIGHTS = (Segment("x", 6, 18), Segment("y", 6, 18))


@dataclass(frozen=True, eq=False)
class _Face:
    """Power onto a face is state @ receive; the destination gains power * emit."""

    receive: F64
    emit: F64


@dataclass(frozen=True, eq=False)
class _Hop:
    offset: tuple[int, int]
    faces: tuple[_Face, ...]


def basis(angle: ArrayLike, bands: int) -> F64:
    """The orthonormal circular harmonics (..., 2 bands - 1) at `angle`."""
    t = np.asarray(angle, dtype=np.float64)

    # Constant term first, then a cosine and a sine of each band, all of unit norm over the circle.
    k = np.arange(1, bands)
    waves = np.stack([np.cos(t[..., None] * k), np.sin(t[..., None] * k)], axis=-1)
    even = np.full((*t.shape, 1), 1.0 / np.sqrt(2.0 * np.pi))
    return np.concatenate([even, waves.reshape(*t.shape, -1) / np.sqrt(np.pi)], axis=-1)


def span_moments(low: ArrayLike, high: ArrayLike, bands: int) -> F64:
    """The integral of `basis` over the angles low..high, (..., 2 bands - 1)."""
    a, b = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    k = np.arange(1, bands)

    # The antiderivatives of the same waves, between the two angles.
    kb, ka = b[..., None] * k, a[..., None] * k
    waves = np.stack([(np.sin(kb) - np.sin(ka)) / k, (np.cos(ka) - np.cos(kb)) / k], axis=-1)
    even = (b - a)[..., None] / np.sqrt(2.0 * np.pi)
    return np.concatenate([even, waves.reshape(*a.shape, -1) / np.sqrt(np.pi)], axis=-1)


def cosine_lobe(facing: float, bands: int) -> F64:
    """A clamped cosine of unit power around `facing`."""
    # A clamped cosine's series: odd bands above the first vanish.
    k = np.arange(bands)
    with np.errstate(divide="ignore"):
        even = np.where(k % 2 == 0, np.cos(0.5 * np.pi * k) / (1.0 - k * k), 0.0)
    share = np.where(k == 1, 0.25 * np.pi, even)  # the integral of cos(kt) cos(t) / 2 ahead
    return cast(F64, basis(facing, bands) * np.concatenate([share[:1], np.repeat(share[1:], 2)]))


def fluence(coefficients: F64) -> F64:
    """The integral over all angles (...)."""
    return cast(F64, coefficients[..., 0] * np.sqrt(2.0 * np.pi))


def solve(
    scheme: str,
    lights: Sequence[Segment],
    *,
    bands: int = 2,
    steps: int = STEPS,
    side: int = SIDE_CELLS,
    clamp: bool = True,
) -> F64:
    """What passes through each cell in `steps` steps, start included, (side, side, K).

    Raises SettingsError for an unknown scheme.
    """
    hops = _hops(scheme, bands)
    state = injected(lights, bands=bands, side=side)
    total = state.copy()
    for _ in range(steps):
        state = _step(state, hops, clamp=clamp)
        total += state
    return total


def injected(lights: Sequence[Segment], *, bands: int = 2, side: int = SIDE_CELLS) -> F64:
    """The lights as cosine lobes in the cells that they touch, (side, side, K)."""
    state = np.zeros((side, side, 2 * bands - 1))

    # Cells' values add to what is there: two lights may touch one cell.
    for light in lights:
        cells = (
            state[light.low : light.high, 0]
            if light.border == "x"
            else state[0][light.low : light.high]
        )
        cells += 2.0 * cosine_lobe(light.facing, bands)  # radiance 1: power 2 a metre
    return state


def analytic(lights: Sequence[Segment], *, bands: int = 2, side: int = SIDE_CELLS) -> F64:
    """The true light at the cells' centres, (side, side, K): radiance 1 from every light seen."""
    at = np.arange(side) + 0.5
    x, y = np.meshgrid(at, at)
    total = np.zeros((side, side, 2 * bands - 1))
    for light in lights:
        # Travel directions from the segment's two ends; none lies across the cut of arctan2.
        if light.border == "x":
            ends = (np.arctan2(y - light.high, x), np.arctan2(y - light.low, x))
        else:
            ends = (np.arctan2(y, x - light.low), np.arctan2(y, x - light.high))
        total += span_moments(*ends, bands)
    return total


def relative_l2(found: F64, truth: F64) -> tuple[float, float]:
    """(error, scale): |scale found - truth| / |truth| of fluence with the scale that fits best."""
    # Least squares over all cells, so that the error is one of distribution alone.
    f, t = fluence(found), fluence(truth)
    scale = float((f * t).sum() / max((f * f).sum(), 1e-300))
    return float(np.linalg.norm(scale * f - t) / np.linalg.norm(t)), scale


def _hops(scheme: str, bands: int) -> tuple[_Hop, ...]:
    if scheme not in SCHEMES:
        raise SettingsError(f"unknown flatland scheme '{scheme}'", remedy=nearest(scheme, SCHEMES))
    if scheme in ("dom4", "dom8"):
        return _ordinates(int(scheme[3:]), bands)
    faces = {"paper": _paper_faces, "ray": _ray_faces, "centroid": _centroid_faces}[scheme]
    quarter = 0.5 * np.pi
    return tuple(_Hop(_offset(k * quarter), faces(k * quarter, bands)) for k in range(4))


def _offset(angle: float) -> tuple[int, int]:
    """(dx, dy) of the neighbour at `angle`, a multiple of 45 degrees."""
    return int(np.rint(1.01 * np.cos(angle))), int(np.rint(1.01 * np.sin(angle)))


def _ordinates(count: int, bands: int) -> tuple[_Hop, ...]:
    # Each ordinate keeps its share of the circle and its own direction: light never turns.
    share = 2.0 * np.pi / count
    hops = []
    for angle in share * np.arange(count):
        y = basis(angle, bands)
        hops.append(_Hop(_offset(float(angle)), (_Face(share * y, y),)))
    return tuple(hops)


def _spans() -> tuple[tuple[float, float, float, float], ...]:
    """(low, high, centre, normal) of the far face and the two sides, for the hop along +x."""
    far, corner, side = _FAR_HALF_ANGLE, 0.25 * np.pi, _TO_SIDE_CENTRE
    return (
        (-far, far, 0.0, 0.0),
        (far, corner, side, 0.5 * np.pi),
        (-corner, -far, -side, -0.5 * np.pi),
    )


def _paper_faces(turn: float, bands: int) -> tuple[_Face, ...]:
    return tuple(
        _Face((high - low) * basis(turn + centre, bands), cosine_lobe(turn + normal, bands))
        for low, high, centre, normal in _spans()
    )


def _ray_faces(turn: float, bands: int) -> tuple[_Face, ...]:
    return tuple(
        _Face((high - low) * basis(turn + centre, bands), basis(turn + centre, bands))
        for low, high, centre, _ in _spans()
    )


def _centroid_faces(turn: float, bands: int) -> tuple[_Face, ...]:
    faces = []
    for low, high, _, _ in _spans():
        moments = span_moments(turn + low, turn + high, bands)
        faces.append(_Face(moments, moments / (high - low)))
    return tuple(faces)


def _step(state: F64, hops: Sequence[_Hop], *, clamp: bool) -> F64:
    # Every hop reads the state before the step, so their order does not matter.
    after = np.zeros_like(state)
    for hop in hops:
        gained = np.zeros_like(state)
        for face in hop.faces:
            # A lobe of few bands goes negative behind its peak.
            power = state @ face.receive
            if clamp:
                power = np.maximum(power, 0.0)
            gained += power[..., None] * face.emit
        after += _shifted(gained, hop.offset)
    return after


def _shifted(cells: F64, offset: tuple[int, int]) -> F64:
    """Moved by (dx, dy); what leaves is lost."""
    dx, dy = offset
    height, width = cells.shape[:2]
    moved = np.zeros_like(cells)
    moved[max(dy, 0) : height + min(dy, 0), max(dx, 0) : width + min(dx, 0)] = cells[
        max(-dy, 0) : height + min(-dy, 0), max(-dx, 0) : width + min(-dx, 0)
    ]
    return moved
