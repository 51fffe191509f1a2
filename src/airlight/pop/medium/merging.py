"""Many volumes as one medium: its box, its mean coefficients, and how wide it is.

Their extinctions add up on one grid over all of them (`merged_medium`). Colour, albedo and mean
cosine are the means over all that they hold: only where light goes is solved with them. What is
drawn has each volume's own coefficients, at its own resolution.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...maths.diffusion import density_moments, spread_diffusivity
from ...maths.transforms import F64
from ...scene.checks import Rgb
from ...scene.scene import volume_world_bounds
from ...scene.volume import Volume
from .placement import Width, probed_density


def merged_volume(volumes: Sequence[Volume]) -> Volume:
    """A box around all of them; density 1 is their mean extinction, weighted by mass."""
    # Extinction is averaged by mass, albedo by extinction, g by scattering: then each mean keeps
    # the total of its coefficient.
    mass = np.array([mass_of(volume) for volume in volumes])[:, None]
    sigma_t, albedo, g = (np.array([getattr(v, n) for v in volumes]) for n in _COEFFICIENTS)
    held, scattered = mass * sigma_t, mass * sigma_t * albedo
    boxes = np.array([volume_world_bounds(volume) for volume in volumes])
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    return Volume(
        _mean(held, mass),
        shape="box",
        bounds=((low[0], low[1], low[2]), (high[0], high[1], high[2])),
        albedo=_mean(scattered, held),
        g=_mean(scattered * g, scattered),
    )


_COEFFICIENTS = ("sigma_t", "albedo", "g")


def _mean(sums: F64, weights: F64) -> Rgb:
    r, g, b = sums.sum(axis=0) / np.maximum(weights.sum(axis=0), 1e-30)
    return (float(r), float(g), float(b))


def mass_of(volume: Volume) -> float:
    """Its mean density times its volume, m^3."""
    low, high = np.asarray(volume.bounds)
    size = abs(float(np.linalg.det(volume.world_from_volume[:3, :3]))) * float(np.prod(high - low))
    if volume.density is not None:
        return size * float(volume.density.mean())
    # A sphere fills pi/6 of the box around it.
    return size * (1.0 if volume.shape == "box" else math.pi / 6.0)


def merged_width(volumes: Sequence[Volume], whole: Volume) -> Width:
    """How wide what they hold is: light leaves a puff at its own sides, however many there are.

    Volumes whose boxes meet are one body; each body counts by what it holds. `whole`: all merged.
    """
    # In units of the merged density: what each volume holds, and how dense it is where it holds it.
    unit = max(float(np.mean(whole.sigma_t)), 1e-30)
    held = np.array([mass_of(v) * np.mean(v.sigma_t) / unit for v in volumes])
    density = np.array([_density_by_mass(v) * np.mean(v.sigma_t) / unit for v in volumes])
    box = np.asarray(whole.bounds)
    total = float(held.sum())
    if total <= 0.0:
        return Width(float(np.linalg.norm(box[1] - box[0])) / 6.0, 0.0, 0.0)
    # What is empty has no width.
    full = [i for i, mass in enumerate(held) if mass > 0.0]
    mass, moments = held[full], [_moments(volumes[i]) for i in full]
    centres, spreads = (np.array([m[k] for m in moments]) for k in range(2))
    # Covariances of a body's volumes, each about the body's centre, add up by mass.
    wide = 0.0
    for body in _bodies(np.array([volume_world_bounds(volumes[i]) for i in full])):
        share = mass[body] / mass[body].sum()
        off = centres[body] - share @ centres[body]
        spread = np.einsum("n,nij->ij", share, spreads[body] + off[:, :, None] * off[:, None, :])
        wide += float(mass[body].sum()) / total * spread_diffusivity(spread)
    size = max(float(np.prod(box[1] - box[0])), 1e-30)
    return Width(wide, float(held @ density) / total, total / size)


def _density_by_mass(volume: Volume) -> float:
    """The mean of its density, weighted by mass."""
    probed = probed_density(volume)
    return float((probed**2).sum() / max(float(probed.sum()), 1e-30))


def _moments(volume: Volume) -> tuple[F64, F64]:
    """The centre (3,), m, and the covariance (3, 3), m^2, of its density in the world."""
    probed = probed_density(volume)
    centre, spread = density_moments(probed, 1.0 / np.array(probed.shape[::-1]))
    # From the unit cube of its grid to the world; a covariance takes the edges on both sides.
    low, high = np.asarray(volume.bounds)
    to_world = np.asarray(volume.world_from_volume)
    edges = to_world[:3, :3] * (high - low)
    placed = to_world[:3, :3] @ low + to_world[:3, 3]
    return placed + edges @ centre, edges @ spread @ edges.T


def _bodies(boxes: F64) -> list[NDArray[np.bool_]]:
    """Masks (n,) of the boxes (n, 2, 3) that meet one another, directly or by others."""
    # Boxes meet where they overlap along all axes; then neighbours of neighbours join.
    meet = (boxes[:, None, 0] <= boxes[None, :, 1]).all(axis=-1)
    meet &= meet.T
    while True:
        steps = meet.astype(np.int64)
        wider = np.matmul(steps, steps) > 0
        if np.array_equal(wider, meet):
            return list(np.unique(meet, axis=0))
        meet = wider
