"""Light propagation volumes: the constants, the six hops and one step, in NumPy.

A state is (C, Z, Y, X, 4): per channel and cell the two-band intensity (a, bx, by, bz), W/sr.
Hops are ordered +x -x +y -y +z -z. Two schemes:

paper      Kaplanyan2010 section 3.3: evaluate towards each far face's centre, re-emit a cosine lobe
           along the face's normal
centroid   ours: receive and emit along the mean direction of the face's solid angle, and a share of
           how the light spreads within it; keeps 0.934 of the net direction per hop where the
           paper keeps 0.369
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64, I64
from .solid_angle import polygon_mean_direction, polygon_solid_angle, quad_mean_square
from .transforms import triple

Scheme = Literal["paper", "centroid"]

# Travel directions of the six hops, and so the offsets (dx, dy, dz) to the destination cell.
OFFSETS: I64 = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
# Irradiance from accumulated states: the share of a cell's flux that a surface there receives.
# Measured so that the mean irradiance of a floor beside a 12 x 12-cell wall is right.
LOOKUP_SCALE = 0.69
# How much of the spread of directions within a face a hop keeps. With 0 light turns too soon (walls
# that face the source get .4 of their light, the source's own plane .2 of what it sends), with 1
# it goes straight in beams. Measured on six lit rooms of 16 to 24 cells, black walls, relative L2
# on all walls: .45 at 0, .41 at 0.25, .39 at 0.5, .40 at 0.6; a floor beside a wall wants little:
# .056 at 0, .07 at 0.25, .11 at 0.4.
SPREAD_KEPT = 0.25
# Light should turn as much on its path through a room whatever its cells: what a hop loses of the
# spread is .75 in rooms of 24 cells, whose mean chord is 16, and less in finer ones. With the same
# loss per hop light diffuses in fine lattices: it falls back on what sent it (a Cornell box of 64
# cells: indirect light 1.27 of the truth), and is too bright where it lingers.
_CHORD_CELLS = 16.0
_LARGEST_SPREAD = 0.75
# Light that turns less is isotropic later: fewer steps than that do not know the remaining light.
_STEPS_PER_CHORD = 3.0
LEAST_STEPS = 64
"""Steps made unless more are needed; with the tail they do for 32 cells."""
# How much of the isotropic part of Geomerics2015's lobe surfaces behind a one-way field see. With 0
# floors go black under the light that they reflect; 1 lets them light themselves twice as much.
LEAST_BEHIND = 0.3


@dataclass(frozen=True)
class Face:
    """A face of the destination cell as the source cell's centre sees it.

    Its power is P = solid_angle_sr (a + b.receive); the destination gains a += P/4pi and
    b += P emit + 3/4pi solid_angle_sr spread b. `normal` points out of the destination cell.
    """

    normal: tuple[float, float, float]
    solid_angle_sr: float
    receive: tuple[float, float, float]
    emit: tuple[float, float, float]
    spread: F64


@dataclass(frozen=True)
class Hop:
    """One neighbour: its offset in cells (dx, dy, dz) and its five faces without the shared one."""

    offset: tuple[int, int, int]
    faces: tuple[Face, ...]

    @cached_property
    def matrix(self) -> F64:
        """(4, 4): what the destination's (a, b) gains of the source's, per step."""
        rows = np.zeros((4, 4))
        for face in self.faces:
            gain = np.array([1.0 / (4.0 * np.pi), *face.emit])
            rows += face.solid_angle_sr * np.outer(gain, [1.0, *face.receive])
            rows[1:, 1:] += 3.0 / (4.0 * np.pi) * face.solid_angle_sr * face.spread
        return rows


def face_corners(centre: ArrayLike, normal: ArrayLike) -> F64:
    """Corners (4, 3) of the face with outward axis `normal` of the unit cell at `centre`."""
    # Two axes across the normal, half a cell to either side.
    c, n = np.asarray(centre, dtype=np.float64), np.asarray(normal, dtype=np.float64)
    across = np.roll(n, 1)
    up = np.cross(n, across)
    signs = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    return np.array([c + 0.5 * (n + i * across + j * up) for i, j in signs])


def spread_kept(count: tuple[int, int, int], iterations: int) -> float:
    """What hops keep of the spread in a lattice of (x, y, z) cells, from its mean chord 4V/S.

    SPREAD_KEPT where `iterations` steps do not follow light through it three times.
    """
    # Twice the inverse sum of inverse sides is 4V/S.
    chord = 2.0 / sum(1.0 / n for n in count)
    if iterations < _STEPS_PER_CHORD * chord - 1e-6:
        return SPREAD_KEPT
    loss = (1.0 - SPREAD_KEPT) * _CHORD_CELLS / chord
    return min(max(1.0 - loss, SPREAD_KEPT), _LARGEST_SPREAD)


def enough_steps(count: tuple[int, int, int]) -> int:
    """Steps until light is isotropic in (x, y, z) cells: three mean chords of their cube."""
    return max(LEAST_STEPS, 2 * max(count))


def face_seen(
    offset: ArrayLike, normal: ArrayLike, scheme: Scheme = "centroid", kept: float = SPREAD_KEPT
) -> Face:
    """The face `normal` of the cell at `offset`, seen from the origin, cells of size 1."""
    centre, n = np.asarray(offset, dtype=np.float64), np.asarray(normal, dtype=np.float64)
    corners = face_corners(centre, n)
    # As printed: light arrives along the face's centre and leaves along its normal.
    if scheme == "paper":
        to_centre = centre + 0.5 * n
        receive = to_centre / np.linalg.norm(to_centre)
        emit, spread = n / (2.0 * np.pi), np.zeros((3, 3))
    # As corrected: along the mean direction over the face, with what second moment is kept.
    elif scheme == "centroid":
        receive = polygon_mean_direction(corners)
        emit = 3.0 * receive / (4.0 * np.pi)
        spread = kept * (quad_mean_square(corners) - np.outer(receive, receive))
    else:
        raise ValueError(f"scheme '{scheme}' is unknown; known: paper, centroid")
    omega = float(polygon_solid_angle(corners))
    return Face(triple(n), omega, triple(receive), triple(emit), spread)


@cache
def hops(scheme: Scheme = "centroid", kept: float = SPREAD_KEPT) -> tuple[Hop, ...]:
    """The six hops of a scheme, `kept` as in `spread_kept`. Raises ValueError for an unknown one.

    differs: Kaplanyan2010 section 3.3 weighs by dOmega/4pi and divides by pi, which loses a
    factor 4pi per step; both schemes here keep the power of every hop.
    """
    # Five faces each: none is the one that light came through.
    table = []
    for offset in OFFSETS:
        normals = [n for n in OFFSETS if not np.array_equal(n, -offset)]
        faces = [face_seen(offset, n, scheme, kept) for n in normals]
        x, y, z = (int(v) for v in offset)
        table.append(Hop((x, y, z), tuple(faces)))
    return tuple(table)


def blocked_shares(projected_area: ArrayLike) -> F64:
    """Share (6, Z, Y, X) in [0, 1] that surfaces stop of the light leaving a cell on each hop.

    `projected_area` is (Z+1, Y+1, X+1, 6), for the cells around the lattice's corners (a point p
    falls into floor(p/s + 1/2)): the surfels' area projected on each axis, over s^2, split by the
    side they face, order +x -x +y -y +z -z. Light is stopped by what faces it. The four corners
    of the crossed face are averaged; 3/2 closes a wall that falls between two layers.
    differs: Kaplanyan2010 section 3.2 keeps the surfels as spherical harmonics, which leak.
    """
    area = np.asarray(projected_area, dtype=np.float64)
    shares = []
    for hop, offset in enumerate(OFFSETS):
        axis = 2 - int(np.flatnonzero(offset)[0])
        # What faces against the hop, averaged over the corners of the face that it crosses.
        faces = area[..., hop ^ 1]
        for other in {0, 1, 2} - {axis}:
            faces = 0.5 * (_without_last(faces, other) + _without_first(faces, other))
        trim = _without_first if offset.sum() > 0 else _without_last
        shares.append(np.clip(1.5 * trim(faces, axis), 0.0, 1.0))
    return np.stack(shares)


def _without_first(a: F64, axis: int) -> F64:
    return np.delete(a, 0, axis=axis)


def _without_last(a: F64, axis: int) -> F64:
    return np.delete(a, -1, axis=axis)


def shifted(cells: F64, offset: ArrayLike) -> F64:
    """(..., Z, Y, X, K) moved by (dx, dy, dz), |d| <= 1; what leaves is lost, zeros come in."""
    moved = np.zeros_like(cells)

    # Slices of source and target along each axis, by the sign of the step.
    source: list[slice] = [slice(None)] * cells.ndim
    target = list(source)
    for step, axis in zip(np.asarray(offset).tolist(), (-2, -3, -4), strict=True):
        if step > 0:
            source[axis], target[axis] = slice(None, -1), slice(1, None)
        elif step < 0:
            source[axis], target[axis] = slice(1, None), slice(None, -1)
    moved[tuple(target)] = cells[tuple(source)]
    return moved


def propagate_step(
    state: ArrayLike,
    scheme: Scheme = "centroid",
    blocked: ArrayLike | None = None,
    *,
    clamp_negative: bool = False,
) -> F64:
    """The state (C, Z, Y, X, 4) after every cell has handed all it holds to its neighbours.

    Light that leaves the lattice, and the share in `blocked` (6, Z, Y, X), is gone. Unclamped,
    the power 4pi sum a is kept to rounding; `clamp_negative` drops negative face powers and gains
    power. Source: Kaplanyan2010 section 3.3; scheme as in `hops`.
    """
    # Every hop hands on the whole state, less what its face stops.
    before = np.asarray(state, dtype=np.float64)
    stopped = None if blocked is None else np.asarray(blocked, dtype=np.float64)
    after = np.zeros_like(before)
    for index, hop in enumerate(hops(scheme)):
        leaving = before if stopped is None else before * (1.0 - stopped[index])[..., None]
        gained = _clamped_gain(leaving, hop) if clamp_negative else leaving @ hop.matrix.T
        after += shifted(gained, hop.offset)
    return after


def _clamped_gain(leaving: F64, hop: Hop) -> F64:
    # The paper's face powers are cut at 0.
    gained = np.zeros_like(leaving)
    for face in hop.faces:
        along = leaving @ np.array([1.0, *face.receive])
        power = face.solid_angle_sr * np.maximum(along, 0.0)
        gained += power[..., None] * np.array([1.0 / (4.0 * np.pi), *face.emit])
    return gained


def propagate(
    injected: ArrayLike,
    iterations: int,
    scheme: Scheme = "centroid",
    blocked: ArrayLike | None = None,
    *,
    clamp_negative: bool = False,
) -> F64:
    """Sum of the injected state (C, Z, Y, X, 4) and all `iterations` states after it.

    Source: Kaplanyan2010 section 3.3. differs: blockers stop light in the first step too; the
    paper leaves them out there, lest a surface shadow itself.
    """
    state = np.asarray(injected, dtype=np.float64)
    total = state.copy()
    for _ in range(iterations):
        state = propagate_step(state, scheme, blocked, clamp_negative=clamp_negative)
        total += state
    return total


def surface_irradiance(
    accumulated: ArrayLike, normal: ArrayLike, cell_size_m: float, scale: float = LOOKUP_SCALE
) -> F64:
    """Irradiance, W m^-2, on unit normals (..., 3) of accumulated states (..., 4).

    The state is to be looked up trilinearly at x + n cell_size/2. Two bands of a light field that
    streams one way are negative behind: a lit floor would darken itself. So the field is read as
    one that has the same two moments and is not negative: up to |b| = 1.5 a, that of light which
    fills half of all directions, it is a - (2/3) b.n; from there on a share of it is a beam along
    b. What two bands cannot tell from the beam is not taken for dark: some light is left behind it.
    differs: Kaplanyan2010 section 3.4, see `paper_surface_irradiance`.
    """
    # Mean intensity, net direction, and the cosine of the surface to it.
    s, n = np.asarray(accumulated, dtype=np.float64), np.asarray(normal, dtype=np.float64)
    a, b = s[..., 0], np.linalg.norm(s[..., 1:], axis=-1)
    along = np.einsum("...i,...i->...", s[..., 1:], n) / np.maximum(b, 1e-300)
    # 0 where light is isotropic, 1 where all of it goes one way.
    r = np.minimum(b / np.maximum(3.0 * a, 1e-300), 1.0)
    beam = np.maximum(2.0 * r - 1.0, 0.0)
    spread_out = 1.0 - np.minimum(2.0 * r, 1.0) * along
    flux = (1.0 - beam) * spread_out + beam * 4.0 * np.maximum(-along, 0.0)
    flux = np.maximum(flux, LEAST_BEHIND * (1.0 - r) / (1.0 + r))
    return np.asarray(scale * np.pi * np.maximum(a, 0.0) * flux / cell_size_m**2)


def paper_surface_irradiance(accumulated: ArrayLike, normal: ArrayLike, cell_size_m: float) -> F64:
    """Irradiance, W m^-2: the intensity towards the surface from half a cell away.

    Source: Kaplanyan2010 section 3.4. 2 to 2.4 times too bright beside a wall.
    """
    # Two bands towards the surface, at least 0.
    s, n = np.asarray(accumulated, dtype=np.float64), np.asarray(normal, dtype=np.float64)
    towards = s[..., 0] - np.einsum("...i,...i->...", s[..., 1:], n)
    return np.asarray(4.0 * np.maximum(towards, 0.0) / cell_size_m**2)
