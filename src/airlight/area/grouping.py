"""Which pieces of sources are one light, and which of its pieces one sample stands for.

pieces -> groups of equal power -> strata, a sample each; parts of groups for lattices and media
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..scene.checks import F64, I64
from ..scene.scene import Scene
from .outlines import is_outline
from .pieces import Layout, Pieces, layout, pieces
from .shapes import Kind, Shape, fitted
from .sources import Source, moved, sources
from .strata import clusters, strata
from .stretches import is_long, stretches

SCATTERING_EACH, SCATTERING_MOST = 4, 12
"""Samples that stand for one light, and for all, in lattices and media."""
BUDGET = 2.5
"""Times `samples`: how many all lights have together; each has one at least."""
_TEXTURED_GROUPS = 8  # that a surface of uneven glow is cut into
_UNEVEN = 0.3  # deviation of the glow, of its mean, from which on it is
_ONE_SIDED = 0.6  # length of the mean normal from which on samples send by the cosine alone
MOST_LAYERS = 240
"""Shadow maps; devices have arrays of 256 layers at least."""
_HOLLOW = 0.01  # of its extent, that a middle lies in front of a part from which on it is
_DIM = 1e-4  # of the brightest: lights that are dark for now count as much


@dataclass(frozen=True, eq=False)
class Group:
    """Rows of pieces, cut into strata, of which some send to all sides; `spot`: its source."""

    rows: I64
    strata: list[I64]
    has_cube: tuple[bool, ...]
    spot: int

    @property
    def layers(self) -> int:
        """Views of its samples: six of a cube, three of one side."""
        return sum(6 if cube else 3 for cube in self.has_cube)


@dataclass(frozen=True, eq=False)
class Grouping:
    """A scene's sources in pieces as they are `found` in a frame.

    `weights` (n,): what the pieces are grouped by, their power (W) in the first frame.
    """

    sources: list[Source]
    cut: Layout
    found: Pieces
    weights: F64

    def moved(self, scene: Scene) -> Grouping:
        """The same pieces where they are in `scene`."""
        own = [moved(source, scene) for source in self.sources]
        return replace(self, sources=own, found=pieces(own, self.cut))

    @property
    def edges(self) -> F64:
        """(n, 3) metres: lengths of the pieces' edges, which tell whether a light kept its form."""
        corners = self.found.corners
        return np.asarray(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2))

    def _features(self) -> F64:
        """(n, 6): position and normal; opposite normals are four times as far apart as sources are
        large: what faces two ways is one only where sources are many.
        """
        count = len(self.sources)
        # How large each source is, by the longest side of its pieces' box.
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        np.minimum.at(low, self.cut.source, self.found.positions)
        np.maximum.at(high, self.cut.source, self.found.positions)
        size = (high - low).max(axis=1)[self.cut.source]
        # Opposite unit normals are 2 apart: twice the mean size of sources makes that four sizes.
        scale = 2.0 * float(np.average(size, weights=self.weights + 1e-30))
        return np.concatenate([self.found.positions, scale * self.found.normals], axis=1)

    def groups(self, samples: int, most: int) -> list[Group]:
        """All pieces in groups; a spot light's ball alone, no other light fades as it does."""
        cut, weights = self.cut, self.weights
        spots = [row for row, source in enumerate(self.sources) if source.spot]
        is_spot = np.isin(cut.source, spots)
        # Spots stay alone, since they send by direction; all others are clustered.
        room = max(1, min(most, int(BUDGET * samples)) - len(spots))
        own = np.where(is_spot, 0.0, weights)
        groups = [(rows, -1) for rows in clusters(self._features(), own, self._atoms(), room)]
        groups += [(np.flatnonzero(cut.source == row), row) for row in spots]
        budget = int(BUDGET * samples)
        # Fewer samples until the layers of all shadow maps fit.
        while True:
            made = self._sampled(groups, samples, budget)
            layers = sum(group.layers for group in made)
            if layers <= MOST_LAYERS or budget == 0:
                return made
            budget = budget * 3 // 4

    def _sampled(self, groups: list[tuple[I64, int]], each: int, budget: int) -> list[Group]:
        """Strata of the groups: `each` of few, else a share of the `budget` by their power."""
        total = max(sum(float(self.weights[rows].sum()) for rows, _ in groups), 1e-300)
        made = []
        for rows, spot in groups:
            # By its share of all power a group has more than the one sample that it needs.
            share = float(self.weights[rows].sum()) / total
            count = min(1 + int(share * max(budget - len(groups), 0)), each)
            # Few groups and the whole budget: even faint ones have as many as settings ask for.
            if len(groups) <= BUDGET and budget >= int(BUDGET * each):
                count = each
            # A stratum is one sample, with a cube of maps where its light leaves to all sides.
            own = self._strata(rows, count)
            cubes = tuple(spot < 0 and self.is_round(part) for part in own)
            made.append(Group(rows, own, cubes, spot))
        return made

    def shape(self, rows: I64) -> Shape:
        """The closed form of a group of pieces, or samples if it has none, as have meshes that
        were one light and glow differently in this frame."""
        own, is_one = self.found.taken(rows), self._is_one(rows)
        shape, glow = fitted(own, is_one=is_one), own.radiance.mean(axis=1)
        if is_one and np.ptp(self.cut.source[rows]) and glow.std() > _UNEVEN * glow.mean():
            return replace(shape, kind=Kind.SAMPLES, corners=None)
        return shape

    def is_outlined(self, rows: I64, shape: Shape) -> bool:
        """Whether what is seen of a group is its polygon, with the same glow all over."""
        # Holes and transmittance would show what lies behind the polygon.
        source = self.sources[int(self.cut.source[rows[0]])]
        material = source.surface.material
        is_whole = not (material.is_blended or material.alpha_cutoff or material.transmission)
        if not (source.is_solid and is_whole and self._is_one(rows)):
            return False
        return is_outline(shape, self.found.taken(rows))

    def _is_one(self, rows: I64) -> bool:
        return bool((self.cut.part[rows] == self.cut.part[rows[0]]).all())

    def _strata(self, rows: I64, count: int) -> list[I64]:
        """A group in strata of equal power; one surface of no closed form in straight stretches."""
        if self._is_one(rows) and self.shape(rows).kind == Kind.SAMPLES:
            parts = stretches(self.found.corners[rows], self.weights[rows], count)
        else:
            parts = strata(self._own_features(rows), self.weights[rows], count)
            # Every other one first, as on a chessboard: half of them tell what is lit all over.
            order = sorted(range(len(parts)), key=lambda k: k.bit_count() % 2)
            parts = [parts[k] for k in order]
        return [rows[part] for part in parts]

    def is_round(self, rows: I64) -> bool:
        """Whether pieces face all sides, and send to all."""
        # The mean normal, by power: short where pieces face all sides.
        weight = self.weights[rows]
        mean = weight @ self.found.normals[rows] / max(float(weight.sum()), 1e-300)
        return float(np.linalg.norm(mean)) < _ONE_SIDED

    def is_body(self, rows: I64) -> bool:
        """Whether pieces are round and face away from their middle, as a ball's do, no dome's."""
        return self.is_round(rows) and self._outwards(rows) > 0.0

    def is_hollow(self, rows: I64) -> bool:
        """Whether pieces of one body face their middle, as a part of the inside of a dome does."""
        # How far its middle lies in front of it, beside its own size.
        extent = float(np.sqrt(self.found.areas[rows].sum()))
        is_one = np.ptp(self.cut.body[rows]) == 0
        return bool(is_one) and self._outwards(rows) < -_HOLLOW * extent

    def _outwards(self, rows: I64) -> float:
        """How far, m, pieces are in front of a middle that they face away from, in the mean."""
        # Offsets from the middle along the normals, in the mean by power.
        found, weight = self.found.taken(rows), self.weights[rows]
        weight = weight / max(float(weight.sum()), 1e-300)
        return float(weight @ ((found.positions - weight @ found.positions) * found.normals).sum(1))

    def _atoms(self) -> I64:
        """Pieces of one number stay together: smooth parts; what glows unevenly in patches."""
        atoms = self.cut.part.copy()
        first = int(atoms.max(initial=0)) + 1
        for row in range(len(self.sources)):
            own = np.flatnonzero(self.cut.source == row)
            # A texture much brighter in places cuts its source again, into parts of equal power.
            glow = self.found.radiance[own].mean(axis=1)
            if glow.std() > _UNEVEN * max(glow.mean(), 1e-30):
                # Dark pieces send nothing: they may stay with any number.
                kept = own[self.weights[own] > 0.0]
                patches = strata(self.found.positions[kept], self.weights[kept], _TEXTURED_GROUPS)
                for patch in patches:
                    atoms[kept[patch]] = first
                    first += 1
        return atoms

    def _own_features(self, rows: I64) -> F64:
        """Coordinates by which a group is cut into strata: along its plane, where it is flat."""
        # Flat groups are cut in their plane, others in space.
        points, normals = self.found.positions[rows], self.found.normals[rows]
        mean = normals.mean(axis=0)
        if np.linalg.norm(mean) > 0.999:
            # Axes along the first piece's edges: strata of a rectangle are rectangles.
            a, b, c = self.found.corners[rows[0]]
            edges = [b - a, c - b, a - c]
            along = sorted(edges, key=lambda edge: float(np.linalg.norm(edge)))[0]
            side = along / max(float(np.linalg.norm(along)), 1e-30)
            up = np.cross(mean / np.linalg.norm(mean), side)
            return np.stack([points @ side, points @ up], axis=1)
        return points

    def scattering(self, groups: Sequence[Group]) -> list[I64]:
        """Rows of pieces that one point each stands for in lattices and media: parts of groups.

        What faces out of a room does not mix with what lights it.
        """
        own = [group.rows for group in groups if group.spot < 0]
        if not own:
            return []
        # More groups than media may have lights: groups are clustered again, whole.
        if len(own) > SCATTERING_MOST:
            number = np.zeros(len(self.weights), np.int64)
            is_own = np.zeros(len(self.weights), bool)
            for k, rows in enumerate(own):
                number[rows], is_own[rows] = k, True
            weights = np.where(is_own, self.weights, 0.0)
            return clusters(self._features(), weights, number, SCATTERING_MOST)
        # Else each group has points by its power.
        total = max(sum(float(self.weights[rows].sum()) for rows in own), 1e-300)
        found = []
        for rows in own:
            share = float(self.weights[rows].sum()) / total
            # Parts of the inside of a dome are flat only where they are many.
            most = SCATTERING_MOST if self.is_hollow(rows) else SCATTERING_EACH
            count = min(1 + int(share * (SCATTERING_MOST - len(own))), most)
            # A ball sends to all sides alike; its parts would leave gaps between their normals.
            if self.is_body(rows) and not is_long(self.found.corners[rows], self.weights[rows]):
                count = 1
            parts = strata(self._own_features(rows), self.weights[rows], count)
            found += [rows[part] for part in parts]
        return found

    def again(self, first: tuple[list[Group], list[I64], F64]) -> tuple[list[Group], list[I64]]:
        """Groups and what stands for them in lattices, with strata for lights as large as now.

        What keeps its form keeps its `first` strata, so that samples turn with it: groups, what
        stood for them in lattices, and the `edges` of then.
        """
        groups, scattering, edges = first
        if np.allclose(edges, self.edges, rtol=1e-4, atol=0.0):
            return groups, scattering
        # Lights have another form: groups keep their pieces, strata are cut from it.
        again = []
        for group in groups:
            own = self._strata(group.rows, len(group.strata))
            again.append(replace(group, strata=own))
        return again, self.scattering(groups)


def grouping(scene: Scene) -> Grouping:
    """The pieces of a scene's sources, weighted as they shine in it."""
    own = sources(scene)
    cut = layout(own)
    found = pieces(own, cut)
    return Grouping(own, cut, found, _weights(own, cut, found))


def _weights(own: list[Source], cut: Layout, found: Pieces) -> F64:
    """Power (n,), W; lights that are dark for now have a little, meshes' dark parts none."""
    # Lights may come on later: a little power keeps them in a group.
    is_light = np.array([s.light >= 0 for s in own], bool)[cut.source]
    brightest = float((found.power / np.maximum(found.areas, 1e-30)).max(initial=0.0))
    least = _DIM * max(brightest, 1e-12) * found.areas
    return np.asarray(np.where(is_light, np.maximum(found.power, least), found.power))
