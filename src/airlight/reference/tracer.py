"""Our own Monte Carlo light tracer for a scattering medium in a box.

Independent of the GPU code and of Mitsuba, it reports what Mitsuba does not: fluence and net
flux per cell, light by scattering order, the energy that leaves each face, the brightness seen
from outside, and the directions of light in a slice (Elek2014, Fig. 12), each with a standard
error from independent batches.

>>> medium = BoxMedium(sigma_t=4.0, g=0.7)
>>> light = trace(medium, Beam((0, 0, 1)), photons=100_000)
>>> light.exits[1:].sum(axis=0)          # scattered light through -x, +x, -y, +y, -z, +z, W
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from types import ModuleType
from typing import cast

import numpy as np

from ..errors import ReferenceFailure
from ..scene.checks import F64, Vec3
from .tracer_setup import (
    Beam,
    BoxMedium,
    Domain,
    Emitting,
    IsotropicEnvironment,
    PointSource,
    Slice,
    Source,
    Tally,
)

__all__ = [
    "Beam",
    "BoxMedium",
    "Emitting",
    "IsotropicEnvironment",
    "PointSource",
    "Slice",
    "Transport",
    "fluence",
    "trace",
]

Progress = Callable[[float], None]
FACES = ("-x", "+x", "-y", "+y", "-z", "+z")


@dataclass(frozen=True, eq=False)
class Transport:
    """Where the light went. Every array has a twin `*_error`: its standard error.

    The first axis of `fluence`, `flux`, `exits` is the scattering order: unscattered, once,
    twice or more. Fluence is the integral of radiance over directions, W m^-2; flux its vector
    form, in x, y, z; exits the power W through the faces named by FACES. `brightness` (2, views)
    is radiant intensity W sr^-1 towards each view direction, scattered once and more often.
    `slice_radiance` (2, b, a, mu, phi) is W m^-2 sr^-1, unscattered and scattered, in equal solid
    angles: a and b are the slice's axes in the order x, y, z, mu the cosine to its normal in equal
    steps from -1 to 1, phi = atan2(d_b, d_a) around 2 pi k / count.
    """

    fluence: F64
    flux: F64
    exits: F64
    absorbed: float
    entered: float
    brightness: F64
    slice_radiance: F64
    fluence_error: F64
    flux_error: F64
    exits_error: F64
    absorbed_error: float
    brightness_error: F64
    slice_radiance_error: F64
    photons: int

    @property
    def scattered_fluence(self) -> F64:
        """Fluence (z, y, x) of light scattered at least once, W m^-2."""
        return cast(F64, self.fluence[1:].sum(axis=0))

    @property
    def scattered_exits(self) -> F64:
        """Power (6,) through each face of light scattered at least once, W."""
        return cast(F64, self.exits[1:].sum(axis=0))


def trace(
    medium: BoxMedium,
    source: Source,
    *,
    cells: tuple[int, int, int] = (16, 16, 16),
    photons: int = 1_000_000,
    batches: int = 16,
    seed: int = 0,
    views: Sequence[Vec3] = (),
    plane: Slice | None = None,
    directions: tuple[int, int] = (5, 36),
    progress: Progress | None = None,
) -> Transport:
    """Trace `photons` from `source` through `medium`; tally them in `cells` (z, y, x).

    The standard errors come from `batches` independent parts, each with its own seed made of
    `seed`: the result does not depend on the number of processor cores. `views` are directions
    of travel towards distant eyes. `plane` asks for `slice_radiance` in `directions` = (mu, phi)
    bins. Raises ReferenceFailure where Numba is missing or the light misses the box.
    """
    if batches < 2 or photons < batches or min(cells) < 1:
        raise ReferenceFailure("a trace needs at least 2 batches, a photon in each, and a cell")
    # What the compiled kernel takes: plain tuples and arrays.
    kernel = _kernel()
    emitter, power = source.emitter(medium.bounds)
    domain, chosen = medium.domain(), plane or Slice(-1, 0)
    looks = _unit_rows(views)
    shapes = _tally_shapes(cells, len(views), chosen, directions)
    per_batch = photons // batches

    def one_batch(batch_seed: int) -> Tally:
        tally = Tally(*(np.zeros(shape) for shape in shapes))
        kernel.run_batch(domain, emitter, chosen, looks, per_batch, power, int(batch_seed), tally)
        return tally

    # Independent batches, whose spread is the standard error.
    seeds = np.random.SeedSequence(seed).generate_state(batches)
    total, squares = _add_up(one_batch, seeds.tolist(), progress)
    return _transport(total, squares, batches, per_batch * batches, domain)


def fluence(
    kind: str,
    optical_depth_per_cell: float,
    *,
    cells: int = 25,
    albedo: float = 0.9,
    g: float = 0.0,
    beam_cells: int = 1,
    photons: int = 1_000_000,
    seed: int = 0,
) -> Transport:
    """The measuring set-up for lattices: a cube of `cells`^3 cells of 1 m, lit at its centre.

    `kind` is "point" (1 W from the centre of the middle cell, in all directions) or "beam" (1 W
    along +z through the middle `beam_cells` by `beam_cells` cells of the face z = 0).
    Raises ReferenceFailure for another kind.
    """
    side = float(cells)
    middle = 0.5 * side
    # Either source gives 1 W, so that results say which share of the power arrives where.
    source: Source
    if kind == "point":
        source = PointSource((middle, middle, middle), 1.0 / (4.0 * math.pi))
    elif kind == "beam":
        low, high = middle - 0.5 * beam_cells, middle + 0.5 * beam_cells
        window = ((low, low, -1.0), (high, high, 1.0))
        source = Beam((0.0, 0.0, 1.0), 1.0 / beam_cells**2, window)
    else:
        raise ReferenceFailure(f"'{kind}' is no light of this set-up", remedy="Use point or beam.")
    bounds = ((0.0, 0.0, 0.0), (side, side, side))
    medium = BoxMedium(optical_depth_per_cell, albedo, g, bounds)
    return trace(medium, source, cells=(cells, cells, cells), photons=photons, seed=seed)


def _kernel() -> ModuleType:
    try:
        from . import tracer_kernel
    except ImportError as missing:
        raise ReferenceFailure(
            "the Monte Carlo tracer needs Numba",
            remedy="Install it with: pip install 'airlight[reference]'.",
        ) from missing
    return tracer_kernel


def _unit_rows(views: Sequence[Vec3]) -> F64:
    rows = np.array(views, dtype=np.float64).reshape(-1, 3)
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    if np.any(length == 0.0):
        raise ReferenceFailure("a view direction is zero, it must point somewhere")
    return cast(F64, rows / length)


def _tally_shapes(
    cells: tuple[int, int, int], views: int, plane: Slice, directions: tuple[int, int]
) -> tuple[tuple[int, ...], ...]:
    """The shapes of a `Tally`'s arrays, in its order."""
    in_plane = [count for axis, count in zip((2, 1, 0), cells, strict=True) if axis != plane.axis]
    sliced = (2, *in_plane, *directions) if plane.axis >= 0 else (2, 0, 0, 1, 1)
    return ((3, *cells, 4), (3, 6), (2,), (2, views), sliced)


def _add_up(
    one_batch: Callable[[int], Tally], seeds: list[int], progress: Progress | None
) -> tuple[Tally, Tally]:
    """Sum and sum of squares over batches, always in the order of the seeds.

    Only as many batches as there are cores are held at a time: lattices can be large.
    """
    workers = min(len(seeds), os.cpu_count() or 1)
    total: list[F64] = []
    squares: list[F64] = []
    done = 0
    waiting: Iterator[int] = iter(seeds)
    # In groups, added up in the seeds' order: the sum does not depend on which batch is done
    # first.
    with ThreadPoolExecutor(workers) as pool:
        while group := list(islice(waiting, workers)):
            for tally in pool.map(one_batch, group):
                if not total:
                    total, squares = [np.zeros_like(a) for a in tally], [a * 0.0 for a in tally]
                for sum_, square, part in zip(total, squares, tally, strict=True):
                    sum_ += part
                    square += part * part
                done += 1
            if progress is not None:
                progress(done / len(seeds))
    return Tally(*total), Tally(*squares)


def _transport(
    total: Tally,
    squares: Tally,
    batches: int,
    photons: int,
    domain: Domain,
) -> Transport:
    """Means and standard errors of the batches, divided by what makes them densities."""
    # Standard error of the mean over independent batches.
    mean = [a / batches for a in total]
    error = [
        np.sqrt(np.maximum(s / batches - m * m, 0.0) / (batches - 1))
        for s, m in zip(squares, mean, strict=True)
    ]
    # Track lengths over a cell's volume are fluence; over a bin's solid angle, too, radiance.
    size = np.subtract(domain.high, domain.low)
    volume = float(np.prod(size)) / math.prod(mean[0].shape[1:4])
    bins = mean[4].shape[3] * mean[4].shape[4]
    radiance = bins / (4.0 * math.pi * volume)
    return Transport(
        fluence=mean[0][..., 0] / volume,
        flux=mean[0][..., 1:] / volume,
        exits=mean[1],
        entered=float(mean[2][0]),
        absorbed=float(mean[2][1]),
        brightness=mean[3],
        slice_radiance=mean[4] * radiance,
        fluence_error=error[0][..., 0] / volume,
        flux_error=error[0][..., 1:] / volume,
        exits_error=error[1],
        absorbed_error=float(error[2][1]),
        brightness_error=error[3],
        slice_radiance_error=error[4] * radiance,
        photons=photons,
    )
