"""A scene's lights with extent, frame by frame: shapes, samples on them, and what stands for them
where lattices and media are lit. Media that give off light are among them (`glowing`).

Which pieces are one light is decided once, for the scene that they are made for; where they are,
what they give and, where they change their form, which of them a sample stands for follows every
frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..maths.sampling import orthonormal_frame
from ..scene.checks import F64
from ..scene.lights import Light, LightSample, SpotLight
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from .emitter import Emitter, Sample
from .glowing import GlowingMedia
from .pieces import layout, pieces
from .shapes import fitted
from .sources import has_extent, moved, sources
from .strata import clusters, strata

I64 = NDArray[np.int64]
SCATTERING_EACH, SCATTERING_MOST = 4, 12
"""Samples that stand for one light, and for all, in lattices and media."""
BUDGET = 2.5
"""Times `samples`: how many all lights have together; each has one at least."""
_TEXTURED_GROUPS = 8  # that a surface of uneven glow is cut into
_UNEVEN = 0.3  # deviation of the glow, of its mean, from which on it is
_ONE_SIDED = 0.6  # length of the mean normal from which on samples send by the cosine alone
_OFF_PLANE = 0.01  # of its extent, from which on a part is not flat
_GOLDEN = 0.6180339887498949
MOST_LAYERS = 240
"""Shadow maps; devices have arrays of 256 layers at least."""
_DIM = 1e-4  # of the brightest: lights that are dark for now count as much


@dataclass(frozen=True, eq=False)
class _Group:
    """Rows of pieces, cut into strata, of which some send to all sides; `spot`: its source."""

    rows: I64
    strata: list[I64]
    has_cube: tuple[bool, ...]
    spot: int


class Emitters:
    """The lights with extent of a scene; `of` takes the scene as it is in a frame."""

    def __init__(self, scene: Scene, *, samples: int, most: int, cell: float = 0.0) -> None:
        """`samples`: of a light alone; `most`: how many lights there are, larger groups beyond.

        `cell`, metres: of the lattice, which does not know what is closer to a light.
        """
        self._cell = cell
        self._sources = sources(scene)
        self._cut = layout(self._sources)
        self._found = pieces(self._sources, self._cut)
        self._weights = self._grouping_weights()
        self._groups = self._grouped(samples, most) if self._sources else []
        self._scattering = self._scattering_groups()
        self._first = self._groups, self._scattering, _edges(self._found.corners)
        self._glowing = GlowingMedia(scene)
        if self._glowing.is_any:
            taken = sum(6 if cube else 3 for group in self._groups for cube in group.has_cube)
            self._glowing.group(samples, int(BUDGET * samples), (MOST_LAYERS - taken) // 6)
        self.version = 0
        """Raised whenever anything of them changed."""
        self.plain = len([light for light in scene.lights if not has_extent(light)])
        """How many lights without extent there are: the first rows of the scene's lights."""
        self.list: tuple[Emitter, ...] = ()
        self._seen: Scene | None = None
        self._last: tuple[tuple[Mesh, ...], tuple[Light, ...]] | None = None

    @property
    def count(self) -> int:
        """How many there are, in every frame."""
        return len(self._groups) + len(self._glowing.groups)

    @property
    def layers(self) -> int:
        """Views of all samples, in every frame."""
        surfaces = sum(6 if cube else 3 for group in self._groups for cube in group.has_cube)
        return surfaces + 6 * self._glowing.sample_count

    @property
    def sample_count(self) -> int:
        """Samples of all, in every frame."""
        return sum(len(group.strata) for group in self._groups) + self._glowing.sample_count

    def of(self, scene: Scene) -> Scene:
        """The scene as lattices and media see it: samples in place of lights with extent.

        Takes the emitters as they are in it. The very same scene where there are none.
        """
        if not self.count:
            return scene
        last, glow_changed = self._last, self._glowing.take(scene)
        if last is None or glow_changed or last[0] is not scene.meshes or last[1] != scene.lights:
            self._last = (scene.meshes, scene.lights)
            self.version += 1
            self._sources = [moved(source, scene) for source in self._sources]
            self._found = pieces(self._sources, self._cut)
            self._groups, self._scattering = self._cut_again()
            self._bodies = self._radii()
            self._lights = self._as_points(scene)
            first = len(self._lights) - len(self._glowing.groups)
            stand_ins = self._stand_ins()
            surfaces = tuple(map(self._emitter, self._groups, stand_ins))
            self.list = surfaces + self._glowing.emitters(first, 0)
        return replace(scene, lights=self._lights)

    def jittered(self, index: int) -> tuple[Emitter, ...]:
        """The emitters with other samples on them, those of a still's sample `index`."""
        if index == 0:
            return self.list
        surfaces = tuple(
            replace(
                emitter,
                samples=tuple(
                    self._sample(rows, k, index, has_cube=cube)
                    for k, (rows, cube) in enumerate(zip(group.strata, group.has_cube, strict=True))
                ),
            )
            for emitter, group in zip(self.list, self._groups, strict=False)
        )
        first = len(self._lights) - len(self._glowing.groups)
        return surfaces + self._glowing.emitters(first, index)

    def _grouping_weights(self) -> F64:
        """Power (n,), W; lights that are dark for now have a little, meshes' dark parts none."""
        power = self._found.power
        is_light = np.array([s.light >= 0 for s in self._sources], bool)[self._cut.source]
        brightest = float((power / np.maximum(self._found.areas, 1e-30)).max(initial=0.0))
        least = _DIM * max(brightest, 1e-12) * self._found.areas
        return np.asarray(np.where(is_light, np.maximum(power, least), power))

    def _features(self) -> F64:
        """(n, 6): position and normal; opposite normals are four times as far apart as sources are
        large: what faces two ways is one only where sources are many.
        """
        count = len(self._sources)
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        np.minimum.at(low, self._cut.source, self._found.positions)
        np.maximum.at(high, self._cut.source, self._found.positions)
        size = (high - low).max(axis=1)[self._cut.source]
        scale = 2.0 * float(np.average(size, weights=self._weights + 1e-30))
        return np.concatenate([self._found.positions, scale * self._found.normals], axis=1)

    def _grouped(self, samples: int, most: int) -> list[_Group]:
        """All pieces in groups; a spot light's ball alone, no other light fades as it does."""
        cut, weights = self._cut, self._weights
        spots = [row for row, source in enumerate(self._sources) if source.spot]
        is_spot = np.isin(cut.source, spots)
        room = max(1, min(most, int(BUDGET * samples)) - len(spots))
        own = np.where(is_spot, 0.0, weights)
        groups = [(rows, -1) for rows in clusters(self._features(), own, self._atoms(), room)]
        groups += [(np.flatnonzero(cut.source == row), row) for row in spots]
        budget = int(BUDGET * samples)
        while True:
            made = self._sampled(groups, samples, budget)
            layers = sum(6 if cube else 3 for group in made for cube in group.has_cube)
            if layers <= MOST_LAYERS or budget == 0:
                return made
            budget = budget * 3 // 4

    def _sampled(self, groups: list[tuple[I64, int]], each: int, budget: int) -> list[_Group]:
        """Strata of the groups: `each` of few, else a share of the `budget` by their power."""
        total = max(sum(float(self._weights[rows].sum()) for rows, _ in groups), 1e-300)
        made = []
        for rows, spot in groups:
            share = float(self._weights[rows].sum()) / total
            count = min(1 + int(share * max(budget - len(groups), 0)), each)
            if len(groups) <= BUDGET and budget >= int(BUDGET * each):
                count = each
            parts = strata(self._own_features(rows), self._weights[rows], count)
            own = [rows[part] for part in parts]
            cubes = tuple(spot < 0 and self._is_round(part) for part in own)
            made.append(_Group(rows, own, cubes, spot))
        return made

    def _is_round(self, rows: I64) -> bool:
        """Whether pieces face all sides, and send to all."""
        weight = self._weights[rows]
        mean = weight @ self._found.normals[rows] / max(float(weight.sum()), 1e-300)
        return float(np.linalg.norm(mean)) < _ONE_SIDED

    def _atoms(self) -> I64:
        """Pieces of one number stay together: smooth parts; what glows unevenly in patches."""
        atoms = self._cut.part.copy()
        first = int(atoms.max(initial=0)) + 1
        for row in range(len(self._sources)):
            own = np.flatnonzero(self._cut.source == row)
            # Both sides of a sheet have parts of their own.
            atoms[own] = atoms[own] + first
            first = int(atoms[own].max(initial=first)) + 1
            glow = self._found.radiance[own].mean(axis=1)
            if glow.std() > _UNEVEN * max(glow.mean(), 1e-30):
                kept = own[self._weights[own] > 0.0]
                patches = strata(self._found.positions[kept], self._weights[kept], _TEXTURED_GROUPS)
                for patch in patches:
                    atoms[kept[patch]] = first
                    first += 1
        return atoms

    def _own_features(self, rows: I64) -> F64:
        """Coordinates by which a group is cut into strata: along its plane, where it is flat."""
        points, normals = self._found.positions[rows], self._found.normals[rows]
        mean = normals.mean(axis=0)
        if np.linalg.norm(mean) > 0.999:
            # Axes along the first piece's edges: strata of a rectangle are rectangles.
            a, b, c = self._found.corners[rows[0]]
            edges = [b - a, c - b, a - c]
            along = sorted(edges, key=lambda edge: float(np.linalg.norm(edge)))[0]
            side = along / max(float(np.linalg.norm(along)), 1e-30)
            up = np.cross(mean / np.linalg.norm(mean), side)
            return np.stack([points @ side, points @ up], axis=1)
        size = float(np.ptp(points, axis=0).max(initial=0.0))
        return np.concatenate([points, 0.25 * size * normals], axis=1)

    def _scattering_groups(self) -> list[I64]:
        """Rows of pieces that one point each stands for in lattices and media: parts of groups.

        What faces out of a room does not mix with what lights it.
        """
        own = [group.rows for group in self._groups if group.spot < 0]
        if not own:
            return []
        if len(own) > SCATTERING_MOST:
            number = np.zeros(len(self._weights), np.int64)
            is_own = np.zeros(len(self._weights), bool)
            for k, rows in enumerate(own):
                number[rows], is_own[rows] = k, True
            weights = np.where(is_own, self._weights, 0.0)
            return clusters(self._features(), weights, number, SCATTERING_MOST)
        total = max(sum(float(self._weights[rows].sum()) for rows in own), 1e-300)
        found = []
        for rows in own:
            share = float(self._weights[rows].sum()) / total
            count = min(1 + int(share * (SCATTERING_MOST - len(own))), SCATTERING_EACH)
            parts = strata(self._own_features(rows), self._weights[rows], count)
            found += [rows[part] for part in parts]
        return found

    def _cut_again(self) -> tuple[list[_Group], list[I64]]:
        """Groups and what stands for them in lattices, with strata for lights as large as now.

        What keeps its form keeps its first strata, so that samples turn with it.
        """
        groups, scattering, edges = self._first
        if np.allclose(edges, _edges(self._found.corners), rtol=1e-4, atol=0.0):
            return groups, scattering
        again = []
        for group in groups:
            parts = strata(
                self._own_features(group.rows), self._weights[group.rows], len(group.strata)
            )
            again.append(replace(group, strata=[group.rows[part] for part in parts]))
        return again, self._scattering_groups()

    def _as_points(self, scene: Scene) -> tuple[Light, ...]:
        """Lights without extent, spots on the balls of spot lights, samples, glowing media."""
        plain = [light for light in scene.lights if not has_extent(light)]
        spots = [x for s in self._sources if s.spot for x in _spots(s.spot)]
        samples = [
            self._sample(rows, 0, 0, has_cube=self._is_round(rows)).light
            for rows in self._scattering
        ]
        places = [light.position for light in spots] + [light.position for light in samples]
        self._places = np.array(places).reshape(-1, 3)
        self._first_sample = len(spots)
        return (*plain, *spots, *samples, *self._glowing.lights)

    def _stand_ins(self) -> list[slice]:
        """Of each group, which of those points stand for it alone; else the one nearest to it."""
        owner = np.full(len(self._weights), -1, np.int64)
        for number, group in enumerate(self._groups):
            owner[group.rows] = number
        of_points = [owner[rows] for rows in self._scattering]
        found, spots = [], 0
        for number, group in enumerate(self._groups):
            if group.spot >= 0:
                found.append(slice(4 * spots, 4 * spots + 4))
                spots += 1
                continue
            own = [k for k, by in enumerate(of_points) if (by == number).all()]
            if own and own[-1] - own[0] + 1 == len(own):
                found.append(slice(self._first_sample + own[0], self._first_sample + own[-1] + 1))
                continue
            centre = self._found.positions[group.rows].mean(axis=0)
            far = np.linalg.norm(self._places - centre, axis=1)
            # What is as near but for rounding is the same point wherever the scene stands.
            nearest = int(np.argmax(far <= far.min() * (1.0 + 1e-6) + 1e-12))
            found.append(slice(nearest, nearest + 1))
        return found

    def _radii(self) -> F64:
        """(n,) metres: of disks as large as the solid surfaces that pieces are parts of."""
        areas = np.bincount(self._cut.part, self._found.areas)
        is_solid = np.array([source.is_solid for source in self._sources], bool)
        radii = np.sqrt(areas / np.pi)[self._cut.part]
        return np.asarray(np.where(is_solid[self._cut.source], radii, 0.0))

    def _emitter(self, group: _Group, stand_ins: slice) -> Emitter:
        shape = fitted(self._found.taken(group.rows))
        spot = self._sources[group.spot].spot if group.spot >= 0 else None
        parts = zip(group.strata, group.has_cube, strict=True)
        samples = tuple(
            self._sample(rows, k, 0, has_cube=cube) for k, (rows, cube) in enumerate(parts)
        )
        count = stand_ins.stop - stand_ins.start
        return Emitter(shape, samples, self.plain + stand_ins.start, count, spot)

    def _sample(self, rows: I64, number: int, index: int, *, has_cube: bool) -> Sample:
        """What a stratum sends, from its middle; for later samples of a still, from a piece."""
        found = self._found
        light = found.areas[rows, None] * found.radiance[rows]
        weight = light.sum(axis=1) + 1e-30 * found.areas[rows]
        weight = weight / max(float(weight.sum()), 1e-300)
        points, normals = found.positions[rows], found.normals[rows]
        middle = weight @ points
        mean = weight @ normals
        length = float(np.linalg.norm(mean))
        normal = mean / length if length > 1e-6 else np.array((0.0, 1.0, 0.0))
        extent = float(np.sqrt(found.areas[rows].sum() / np.pi))
        spread = float(np.sqrt(weight @ ((points - middle) ** 2).sum(axis=1)))
        if index and not has_cube:
            at = (0.5 + _GOLDEN * index + 0.7548776662466927 * number) % 1.0
            piece = int(np.searchsorted(np.cumsum(weight), at * weight.sum()))
            piece = min(piece, len(rows) - 1)
            middle, normal = points[piece], normals[piece]
        elif not has_cube and float(np.ptp((points - middle) @ normal)) > _OFF_PLANE * extent:
            # A point of the surface itself: the middle of a curved part lies behind it.
            piece = int(((points - middle) ** 2).sum(axis=1).argmin())
            middle = points[piece]
        front = length if has_cube else 1.0
        r, g, b = light.sum(axis=0)
        sample = LightSample(
            _triple(middle),
            _triple(normal),
            (float(r), float(g), float(b)),
            front,
            (1.0 - length) / 4.0 if has_cube else 0.0,
            max(extent, spread),
            float(weight @ self._bodies[rows]),
            self._cell,
        )
        return Sample(sample, max(extent, spread) if has_cube else 0.0, has_cube)


def _edges(corners: F64) -> F64:
    """(n, 3) metres: lengths of the edges of pieces (n, 3, 3)."""
    return np.asarray(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2))


def _spots(spot: SpotLight) -> list[SpotLight]:
    """Four spots on the ball of one, spread as its disk is."""
    side, up = orthonormal_frame(np.array(spot.direction))
    r, g, b = (0.25 * c for c in spot.intensity)
    return [
        replace(
            spot,
            position=_triple(np.array(spot.position) + 0.5 * spot.radius * (x * side + y * up)),
            intensity=(r, g, b),
            radius=0.0,
        )
        for x, y in ((-1, -1), (1, -1), (-1, 1), (1, 1))
    ]


def _triple(values: F64 | Sequence[float]) -> tuple[float, float, float]:
    return (float(values[0]), float(values[1]), float(values[2]))
