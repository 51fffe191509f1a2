"""What the tracer is asked: a medium in a box and a light, as values and as the kernel's tuples.

No Numba here, so that media and sources can be written down without it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..errors import ReferenceFailure
from ..maths.transforms import triple
from ..scene import checks
from ..scene.checks import F32, F64, Bounds, Vec3
from ..scene.medium import Medium
from ..scene.volume import Volume

Vector = tuple[float, float, float]
HOMOGENEOUS, GRID, ELLIPSOID = 0, 1, 2
BEAM, ENVIRONMENT, POINT, VOXELS = 0, 1, 2, 3
UNIT_CUBE: Bounds = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


class Domain(NamedTuple):
    """The box and what fills it: extinction sigma_t * density(p), m^-1."""

    low: Vector
    high: Vector
    kind: int
    density: F64  # (z, y, x); a dummy unless kind is GRID
    sigma_t: float
    majorant: float
    albedo: float
    g: float


class Emitter(NamedTuple):
    """Where photons start. Rectangles on the box's faces, voxels in it, or one point."""

    kind: int
    cumulative: F64  # (faces,) chance of starting on this face (in this voxel) or an earlier one
    rect_low: F64  # (faces, 3)
    rect_high: F64  # (faces, 3)
    inward: F64  # (faces, 3) unit normals
    direction: Vector  # BEAM: of travel; POINT: axis of the sampled cone
    position: Vector
    cone_cosine: float  # POINT: uniform within this cone, -1 for the whole sphere


class Tally(NamedTuple):
    """What a batch of photons adds up; see `tracer.Transport` for the meaning."""

    track: F64  # (3, z, y, x, 4) W m: length and length * direction
    exits: F64  # (3, 6) W through -x, +x, -y, +y, -z, +z
    totals: F64  # (2,) W entered, absorbed
    brightness: F64  # (2, views) W sr^-1, scattered once and more often
    slice_track: F64  # (2, b, a, mu, phi) W m, unscattered and scattered


class Slice(NamedTuple):
    """The layer of cells whose directions are recorded; axis 0, 1, 2 for x, y, z; -1 for none."""

    axis: int
    layer: int


@dataclass(frozen=True, eq=False)
class BoxMedium:
    """A medium in a box, one channel: coefficients in m^-1, g in (-1, 1), bounds in metres.

    `density` (z, y, x) scales sigma_t, voxel-centred and trilinear as in `Volume`; without it the
    box is homogeneous, or only its inscribed ellipsoid where `shape` is "sphere".
    """

    sigma_t: float
    albedo: float = 1.0
    g: float = 0.0
    bounds: Bounds = UNIT_CUBE
    density: F32 | None = None
    shape: str = "box"

    def __post_init__(self) -> None:
        checks.number(self.sigma_t, "sigma_t", low=0.0)
        checks.number(self.albedo, "albedo", low=0.0, high=1.0)
        checks.number(self.g, "g", low=-0.9999, high=0.9999)
        object.__setattr__(self, "bounds", checks.bounds(self.bounds, "medium bounds"))

    @classmethod
    def of_volume(cls, volume: Volume, channel: int = 0) -> BoxMedium:
        """One channel of a volume, in the volume's own space."""
        return cls(
            sigma_t=volume.sigma_t[channel],
            albedo=volume.albedo[channel],
            g=volume.g[channel],
            bounds=volume.bounds,
            density=volume.density,
            shape="sphere" if volume.shape == "sphere" else "box",
        )

    @classmethod
    def of_medium(cls, medium: Medium, channel: int = 0) -> BoxMedium:
        """One channel of a homogeneous medium that has bounds. Raises ReferenceFailure if not."""
        if medium.bounds is None:
            raise ReferenceFailure("the tracer needs a medium with bounds")
        return cls(
            medium.sigma_t[channel], medium.albedo[channel], medium.g[channel], medium.bounds
        )

    def domain(self) -> Domain:
        """The same for the kernel."""
        # The peak is the majorant of delta tracking: the tighter, the fewer null collisions.
        kind, density, peak = HOMOGENEOUS, np.zeros((1, 1, 1)), 1.0
        if self.density is not None:
            kind, density = GRID, np.ascontiguousarray(self.density, dtype=np.float64)
            peak = float(density.max())
        elif self.shape == "sphere":
            kind = ELLIPSOID
        low, high = self.bounds
        sigma_t = float(self.sigma_t)
        return Domain(
            low, high, kind, density, sigma_t, sigma_t * peak, float(self.albedo), float(self.g)
        )


@dataclass(frozen=True)
class Beam:
    """Parallel light from outside: `irradiance` W m^-2 at normal incidence.

    It enters every face that it reaches, or only the part of them inside `window` (metres):
    a pencil of light.
    """

    direction: Vec3 = (0.0, 0.0, 1.0)
    irradiance: float = 1.0
    window: Bounds | None = None

    def emitter(self, bounds: Bounds) -> tuple[Emitter, float]:
        """For the kernel, and the power that enters, W."""
        # Power through each face by its cosine; faces that look away send none.
        d = np.array(checks.unit_vec3(self.direction, "beam direction"))
        low, high, inward = _faces(bounds)
        if self.window is not None:
            low, high = _within(self.window, low, high, inward)
        power = self.irradiance * _areas(low, high, inward) * np.maximum(0.0, inward @ d)
        return _face_emitter(BEAM, power, low, high, inward, d)


@dataclass(frozen=True)
class IsotropicEnvironment:
    """The same radiance, W m^-2 sr^-1, from everywhere outside the box."""

    radiance: float = 1.0

    def emitter(self, bounds: Bounds) -> tuple[Emitter, float]:
        """For the kernel, and the power that enters, W."""
        # A uniform environment: irradiance pi L on every face, entering by the cosine.
        low, high, inward = _faces(bounds)
        power = self.radiance * math.pi * _areas(low, high, inward)
        return _face_emitter(ENVIRONMENT, power, low, high, inward, np.array([0.0, 0.0, 1.0]))


@dataclass(frozen=True)
class PointSource:
    """Light from a point inside or outside the box, the same in all directions: W sr^-1."""

    position: Vec3
    intensity: float = 1.0

    def emitter(self, bounds: Bounds) -> tuple[Emitter, float]:
        """For the kernel, and the power sent into the sampled cone, W."""
        low, high = map(np.array, bounds)

        # The box's bounding sphere.
        centre, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
        # From outside, only the cone that holds the medium's bounding sphere is sampled.
        away = centre - np.array(self.position)
        distance = float(np.linalg.norm(away))
        cosine, axis = -1.0, np.array([0.0, 0.0, 1.0])
        if distance > radius:
            cosine, axis = math.sqrt(1.0 - (radius / distance) ** 2), away / distance
        none = np.zeros((1, 3))
        emitter = Emitter(
            POINT, np.ones(1), none, none, none, triple(axis), triple(self.position), cosine
        )
        return emitter, 2.0 * math.pi * (1.0 - cosine) * self.intensity


@dataclass(frozen=True, eq=False)
class Emitting:
    """The medium itself: `emission` (z, y, x), W m^-3 sr^-1, constant in each voxel of its box."""

    emission: F32

    @classmethod
    def of_volume(cls, volume: Volume, channel: int = 0) -> Emitting:
        """One channel of a volume, in its own space. Raises ReferenceFailure where it is dark."""
        emission = volume.emission
        if emission is None:
            raise ReferenceFailure("the volume emits nothing")

        # Its own grid of emission, else what its density or its whole box emits.
        values = emission.values
        if values is not None:
            return cls(values[..., channel] * np.float32(emission.radiance[channel]))
        if volume.shape == "sphere":
            raise ReferenceFailure("the tracer knows no emission of a sphere")
        density = np.ones((1, 1, 1), np.float32) if volume.density is None else volume.density
        return cls(density * np.float32(emission.radiance[channel]))

    def emitter(self, bounds: Bounds) -> tuple[Emitter, float]:
        """For the kernel, and the power that the medium emits, W."""
        # An isotropic emitter of coefficient j radiates 4 pi j per volume.
        nz, ny, nx = self.emission.shape
        size = np.subtract(bounds[1], bounds[0]) / (nx, ny, nz)
        power = 4.0 * math.pi * float(np.prod(size)) * self.emission.astype(np.float64).ravel()
        total = float(power.sum())
        if total <= 0.0:
            raise ReferenceFailure("the medium emits no power")
        # Voxels are drawn by power: a cumulative distribution over those that emit at all.
        z, y, x = np.unravel_index(np.flatnonzero(power), self.emission.shape)
        low = np.array(bounds[0]) + np.stack([x, y, z], axis=1) * size
        chance = np.cumsum(power[power > 0.0]) / total
        none = (0.0, 0.0, 0.0)
        emitter = Emitter(VOXELS, chance, low, low + size, np.zeros((1, 3)), none, none, -1.0)
        return emitter, total


Source = Beam | IsotropicEnvironment | PointSource | Emitting


def _faces(bounds: Bounds) -> tuple[F64, F64, F64]:
    """Lower and upper corner and inward normal of the faces -x, +x, -y, +y, -z, +z: (6, 3)."""
    # Both corners of a face lie in its plane.
    low, high = np.tile(bounds[0], (6, 1)), np.tile(bounds[1], (6, 1))
    face, axis = np.arange(6), np.arange(6) // 2
    upper = face % 2 == 1
    plane = np.where(upper, high[face, axis], low[face, axis])
    low[face, axis] = plane
    high[face, axis] = plane
    inward = np.zeros((6, 3))
    inward[face, axis] = np.where(upper, -1.0, 1.0)
    return low, high, inward


def _within(window: Bounds, low: F64, high: F64, inward: F64) -> tuple[F64, F64]:
    """The rectangles' parts inside the window; empty ones where their plane is outside it."""
    # Cut on the two axes in the face's plane; its third coordinate stays.
    first, last = np.maximum(low, window[0]), np.minimum(high, window[1])
    missed = np.any(first > last, axis=1, keepdims=True)
    flat = inward != 0.0
    return np.where(flat | missed, low, first), np.where(flat, high, np.where(missed, low, last))


def _areas(low: F64, high: F64, inward: F64) -> F64:
    """Areas (6,) of axis-aligned rectangles, m^2."""
    area: F64 = np.prod(np.where(inward == 0.0, high - low, 1.0), axis=1)
    return area


def _face_emitter(
    kind: int, power: F64, low: F64, high: F64, inward: F64, direction: F64
) -> tuple[Emitter, float]:
    total = float(power.sum())
    if total <= 0.0:
        raise ReferenceFailure("the light sends no power into the box")

    # Dark faces take no part in the draw.
    lit = power > 0.0
    chance = np.cumsum(power[lit]) / total
    emitter = Emitter(
        kind, chance, low[lit], high[lit], inward[lit], triple(direction), (0.0, 0.0, 0.0), -1.0
    )
    return emitter, total
