"""Diffusion in a box of a medium: one linear solve per colour channel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64


def largest_diffusivity(density: F64, cell: F64) -> float:
    """A third of the medium's effective radius, m: D is capped there.

    In a thin medium 1/(3 sigma) is longer than the medium is wide. Along the principal axes of its
    density a homogeneous ball's radius is sqrt(5) times the standard deviation; the rates at which
    light gets out along the three, as 1/radius^2, add up: what is flat or long is left sideways.
    """
    # An empty medium: any length of its size.
    total = float(density.sum())
    if total <= 0.0:
        return float(np.linalg.norm(cell * np.array(density.shape[::-1]))) / 6.0
    return spread_diffusivity(density_moments(density, cell)[1])


def spread_diffusivity(spread: F64) -> float:
    """The same from the covariance (3, 3) of the density, m^2."""
    return float(np.sqrt(15.0 / (1.0 / np.linalg.eigvalsh(spread)).sum())) / 3.0


def density_moments(density: F64, cell: F64) -> tuple[F64, F64]:
    """The centre (3,), m from the lower corner, and the covariance (3, 3), m^2, of a density."""
    total = float(density.sum())
    # Covariance of cells among each other and within themselves: a cell is not a point.
    spread = np.diag(np.asarray(cell, dtype=np.float64) ** 2 / 12.0)
    at = [(np.arange(n) + 0.5) * h for n, h in zip(density.shape[::-1], cell, strict=True)]
    centre = np.zeros(3)
    for i in range(3):
        for j in range(i, 3):
            rest = tuple(2 - axis for axis in range(3) if axis not in (i, j))
            weight = density.sum(axis=rest) / total
            spread[i, j] += _covariance(weight, at[i], at[j] if j > i else None)
            spread[j, i] = spread[i, j]
            centre[i] = weight @ at[i] if j == i else centre[i]
    return centre, spread


def _covariance(weight: F64, x: F64, y: F64 | None) -> float:
    """Of places with weights (y, x) of sum 1; without y, the variance of x."""
    if y is None:
        return float(weight @ (x - weight @ x) ** 2)
    along_x, along_y = weight.sum(axis=0), weight.sum(axis=1)
    return float((y - along_y @ y) @ weight @ (x - along_x @ x))


def diffusivity(density: F64, sigma_tr: ArrayLike, sigma_a: ArrayLike, largest: float) -> F64:
    """D (z, y, x, channel), m: 1/(3 (sigma_tr + sigma_a)), capped."""
    sigma = density[..., None] * (np.asarray(sigma_tr) + np.asarray(sigma_a))
    return np.asarray(1.0 / np.maximum(3.0 * sigma, 1.0 / largest))


@dataclass(frozen=True, eq=False)
class Diffusion:
    """The operator div(-D grad Phi) + sigma_a Phi on cells of size `cell` (3,), m.

    `d` (z, y, x, channel), m; `sigma_a` (z, y, x, channel), m^-1. `closed` (3, z, y, x): where a
    surface stands before the next cell along x, y and z; `reflectance` (3, 2, z, y, x): what those
    before a cell's lower and upper faces reflect to all sides, at the border from close outside.
    """

    cell: F64
    d: F64
    sigma_a: F64
    closed: NDArray[np.bool_] | None = None
    reflectance: F64 | None = None

    def between(self, axis: int) -> F64:
        """Harmonic means of D on the inner faces across `axis` (0 is x)."""
        low, high = _sides(self.d, axis)
        return np.asarray(2.0 * low * high / (low + high))

    def outflow(self, axis: int, side: int) -> F64:
        """J_n/Phi on an outer face without a source: 1/(h/(2 D) + 2 (1 + rho)/(1 - rho)); rho: of a
        surface close outside."""
        half = 0.5 * self.cell[axis] / _edge(self.d, axis, side)
        return np.asarray(1.0 / (half + self._beyond(axis, side)))

    def _beyond(self, axis: int, side: int) -> F64:
        """Phi/J on an outer face: 2, more before a surface that reflects."""
        if self.reflectance is None:
            return np.full(1, 2.0)
        rho = _edge(self.reflectance[axis, side][..., None], axis, side)
        return np.asarray(2.0 * (1.0 + rho) / (1.0 - rho))

    def apply(self, phi: F64) -> F64:
        """A phi, W m^-3 for phi in W m^-2."""
        return self._divergence(phi, None) + self.sigma_a * phi

    def diagonal(self) -> F64:
        """Of A, m^-1."""
        total = self.sigma_a.copy()

        # Absorption, and the exchange with each neighbour.
        for axis in range(3):
            h = float(self.cell[axis])
            low, high = _sides(total, axis)
            # Across a face to the next cell Fick's law takes D / h^2, unless a wall stands there.
            between = self.between(axis) / h**2
            shut, beyond = self._shut(axis)
            low += np.where(_sides(shut, axis)[0], 0.0, between)
            high += np.where(_sides(beyond, axis)[1], 0.0, between)
            # Onto walls goes what their boundary condition takes.
            for side, walls in enumerate((beyond, shut)):
                total += np.where(walls, self._onto(np.ones_like(total), None, axis, side), 0.0) / h
            # Across the border of the grid leaves what its boundary condition takes.
            for side in (0, 1):
                edge = _edge(total, axis, side)
                edge += self.outflow(axis, side) / h
        return total

    def source(self, power: F64, forward: F64) -> F64:
        """Right-hand side, W m^-3: P/V less the divergence of the deposits' own flux."""
        # The flux that deposits carry leaves one cell and enters the next.
        volume = float(np.prod(self.cell))
        return power / volume - self._divergence(np.zeros_like(power), forward / volume)

    def flux(self, phi: F64, forward: F64) -> F64:
        """J (3, z, y, x, channel), W m^-2, at cell centres: the mean of both faces'."""
        carried = forward / float(np.prod(self.cell))
        sides = (self._around(phi, carried, axis) for axis in range(3))
        return np.stack([0.5 * (low + high) for low, high in sides])

    def exits(self, phi: F64, forward: F64) -> F64:
        """Power (6, channel), W, out through the faces -x, +x, -y, +y, -z, +z."""
        # Each outer layer's flux times the area of its faces.
        carried = forward / float(np.prod(self.cell))
        out = []
        for axis in range(3):
            area = float(np.prod(self.cell) / self.cell[axis])
            for side, sign in ((0, -1.0), (1, 1.0)):
                face = self._outer(phi, carried, axis, side)
                out.append(sign * area * face.sum(axis=(0, 1, 2)))
        return np.stack(out)

    def _divergence(self, phi: F64, source: F64 | None) -> F64:
        total = np.zeros_like(phi)
        for axis in range(3):
            low, high = self._around(phi, source, axis)
            total += (high - low) / self.cell[axis]
        return total

    def _around(self, phi: F64, source: F64 | None, axis: int) -> tuple[F64, F64]:
        """J along `axis` through the lower and the upper face of each cell."""
        # Through faces, unless a surface closes them: there goes what it takes.
        low, high = _sides(self._faces(phi, source, axis), axis)
        shut, beyond = self._shut(axis)
        return (
            np.where(beyond, -self._onto(phi, source, axis, 0), low),
            np.where(shut, self._onto(phi, source, axis, 1), high),
        )

    def _shut(self, axis: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """(z, y, x, 1): whether a surface closes the upper face of a cell; the lower one."""
        # A surface before the next cell closes that cell's lower face, too.
        shape = (*self.d.shape[:3], 1)
        upper = np.zeros(shape, bool) if self.closed is None else self.closed[axis][..., None]
        lower = np.zeros(shape, bool)
        _sides(lower, axis)[1][...] = _sides(upper, axis)[0]
        return upper, lower

    def _onto(self, phi: F64, source: F64 | None, axis: int, side: int) -> F64:
        """J outwards from every cell onto a surface: that of `_outer`, which reflects.

        Source: Marshak's condition with a reflecting boundary, phi = 2 (1 + rho)/(1 - rho) J there
        (Haskell1994).
        """
        # From the cell's middle to the wall by Fick's law, then the wall's own condition.
        half = 0.5 * float(self.cell[axis]) / self.d
        carried = 0.0 if source is None else (1.0 if side else -1.0) * source[axis]
        rho = 0.0 if self.reflectance is None else self.reflectance[axis, side][..., None]
        leaving = phi + half * 3.0 * self.d * carried
        return np.asarray(leaving / (half + 2.0 * (1.0 + rho) / (1.0 - rho)))

    def _faces(self, phi: F64, source: F64 | None, axis: int) -> F64:
        """J along `axis` on all n + 1 faces."""
        h = float(self.cell[axis])
        low, high = _sides(phi, axis)
        between = self.between(axis)
        # Fick's law between cells, then the mean of what deposits carry across the face.
        inner = between * (low - high) / h
        if source is not None:
            b0, b1 = _sides(source[axis], axis)
            inner = inner + 1.5 * between * (b0 + b1)
        outer = [self._outer(phi, source, axis, side) for side in (0, 1)]
        return np.concatenate([outer[0], inner, outer[1]], axis=2 - axis)

    def _outer(self, phi: F64, source: F64 | None, axis: int, side: int) -> F64:
        """J along `axis` on one outer face: (Phi + (h/2D) J_src,n)/(h/(2D) + 2) outwards; beyond
        stands for 2 where a surface close outside reflects."""
        sign = -1.0 if side == 0 else 1.0
        edge = _edge(self.d, axis, side)

        # Half a cell of diffusion in series with Marshak's condition at the face.
        half = 0.5 * float(self.cell[axis]) / edge
        value = _edge(phi, axis, side)
        if source is not None:
            value = value + half * sign * 3.0 * edge * _edge(source[axis], axis, side)
        return np.asarray(sign * value / (half + self._beyond(axis, side)))


def _sides(array: NDArray[Any], axis: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Views of the cells below and above each inner face across `axis`."""
    # Arrays are (z, y, x): x is the last axis.
    at = [slice(None)] * array.ndim
    at[2 - axis] = slice(None, -1)
    low = array[tuple(at)]
    at[2 - axis] = slice(1, None)
    return low, array[tuple(at)]


def _edge(array: F64, axis: int, side: int) -> F64:
    """A view of the first or last layer across `axis`, kept as an axis of length 1."""
    at = [slice(None)] * array.ndim
    at[2 - axis] = slice(0, 1) if side == 0 else slice(-1, None)
    return array[tuple(at)]


def solve(system: Diffusion, rhs: F64, steps: int) -> tuple[F64, F64]:
    """(Phi, residual): `steps` of conjugate gradients, preconditioned by the diagonal.

    The residual (channel,) is |b - A Phi|/|b|, 0 where b is 0. Source: Hestenes1952.
    """
    # The residual of phi = 0, preconditioned, is the first direction of search.
    inverse = 1.0 / system.diagonal()
    phi, r = np.zeros_like(rhs), rhs.copy()
    z = inverse * r
    p, rz = z, _dot(r, z)
    for _ in range(steps):
        # The step that minimises the error along p.
        ap = system.apply(p)
        alpha = _quotient(rz, _dot(p, ap))
        phi += alpha * p
        r -= alpha * ap
        # The next direction is conjugate to all before.
        z = inverse * r
        before, rz = rz, _dot(r, z)
        p = z + _quotient(rz, before) * p
    return phi, np.sqrt(_quotient(_dot(r, r), _dot(rhs, rhs)))


def _dot(a: F64, b: F64) -> F64:
    return np.asarray((a * b).sum(axis=(0, 1, 2)))


def _quotient(a: F64, b: F64) -> F64:
    """a/b, 0 where b is 0: a channel without light stays 0."""
    return np.asarray(np.where(b > 0.0, a / np.where(b > 0.0, b, 1.0), 0.0))
