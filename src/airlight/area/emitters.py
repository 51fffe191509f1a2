"""A scene's lights with extent, frame by frame: shapes, samples on them, and what stands for them
where lattices and media are lit. Media that give off light are among them (`glowing`).

Which pieces are one light is decided once, for the scene that they are made for; where they are,
what they give and, where they change their form, which of them a sample stands for follows every
frame.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..maths.sampling import orthonormal_frame
from ..maths.transforms import triple
from ..scene.checks import F64, I64
from ..scene.lights import Light, LightSample, SpotLight
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from .emitter import Emitter, Sample
from .glowing import GlowingMedia
from .grouping import BUDGET, MOST_LAYERS, Group, grouping
from .outlines import apart
from .places import chosen_share, nearest_to, piece_on_surface, place_inside
from .segments import long_part
from .sizes import body, own_reach, rectangle
from .sources import has_extent


class Emitters:
    """The lights with extent of a scene; `of` takes the scene as it is in a frame."""

    def __init__(self, scene: Scene, *, samples: int, most: int, cell: float = 0.0) -> None:
        """`samples`: of a light alone; `most`: how many lights there are, larger groups beyond.

        `cell`, metres: of the lattice, which does not know what is closer to a light.
        """
        self._cell = cell
        # Surfaces that glow, in groups near each other, and points that stand for them in media.
        own = self._grouping = grouping(scene)
        self._groups = own.groups(samples, most) if own.sources else []
        self._scattering = own.scattering(self._groups)
        self._first = self._groups, self._scattering, own.edges
        # Fire and its like, in groups of blocks with the shadow maps that are left.
        self._glowing = GlowingMedia(scene)
        if self._glowing.is_any:
            taken = sum(group.layers for group in self._groups)
            self._glowing.group(samples, int(BUDGET * samples), (MOST_LAYERS - taken) // 6)
        self.version = 0
        """Raised whenever anything of them changed."""
        self.plain = sum(not has_extent(light) for light in scene.lights)
        """How many lights without extent there are: the first rows of the scene's lights."""
        self.list: tuple[Emitter, ...] = ()
        self._last: tuple[tuple[Mesh, ...], tuple[Light, ...]] | None = None

    @property
    def count(self) -> int:
        """How many there are, in every frame."""
        return len(self._groups) + len(self._glowing.groups)

    @property
    def layers(self) -> int:
        """Views of all samples, in every frame."""
        surfaces = sum(group.layers for group in self._groups)
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
            self._grouping = self._grouping.moved(scene)
            self._groups, self._scattering = self._grouping.again(self._first)
            self._bodies = self._radii()
            # Lights without extent first, then what stands for groups, glowing media last.
            self._lights = self._as_points(scene)
            first = len(self._lights) - len(self._glowing.groups)
            stand_ins = self._stand_ins()
            surfaces = tuple(map(self._emitter, self._groups, stand_ins))
            self.list = apart(surfaces) + self._glowing.emitters(first, 0)
        return replace(scene, lights=self._lights)

    def jittered(self, index: int) -> tuple[Emitter, ...]:
        """The emitters with other samples on them, those of a still's sample `index`."""
        if index == 0:
            return self.list
        # Other samples of the same strata, so that shadows in stills are soft without steps.
        surfaces = tuple(
            replace(emitter, samples=self._samples(group, index))
            for emitter, group in zip(self.list, self._groups, strict=False)
        )
        first = len(self._lights) - len(self._glowing.groups)
        return surfaces + self._glowing.emitters(first, index)

    def _as_points(self, scene: Scene) -> tuple[Light, ...]:
        """Lights without extent, spots on the balls of spot lights, samples, glowing media."""
        plain = [light for light in scene.lights if not has_extent(light)]
        spots = [x for s in self._grouping.sources if s.spot for x in _spots(s.spot)]
        # Each stratum that media see is one light; a hollow part sends from its opening instead.
        samples = [
            self._opening(rows)
            if self._grouping.is_hollow(rows) and not self._grouping.is_round(rows)
            else self._sample(rows, 0, 0, has_cube=self._grouping.is_body(rows)).light
            for rows in self._scattering
        ]
        # Groups that have no points of their own take the nearest of these, see `_stand_ins`.
        places = [light.position for light in spots] + [light.position for light in samples]
        self._places = np.array(places).reshape(-1, 3)
        self._first_sample = len(spots)
        return (*plain, *spots, *samples, *self._glowing.lights)

    def _opening(self, rows: I64) -> LightSample:
        """What a hollow part sends, from the opening through which its light leaves it.

        Before it, a surface of one radiance gives what anything over its rim gives that is as
        bright (Stokes' theorem, of the vector irradiance; solid angles alike): a rectangle there,
        as large as the pieces' areas along the mean normal add up to. Source: ours.
        """
        light = self._sample(rows, 0, 0, has_cube=False).light
        own = self._grouping.found.taken(rows)
        normal = np.array(light.direction)
        share = float(own.areas @ (own.normals @ normal) / own.areas.sum())
        middle = own.areas @ own.positions / own.areas.sum()
        # Of a cap of a sphere the middle is as far behind its rim as before its deepest point.
        rim = -float(((own.corners - middle) @ normal).min())
        # The rectangle and its power shrink to the opening's share of the surface.
        across, along = (math.sqrt(share) * half for half in light.size)
        r, g, b = (share * c for c in light.intensity)
        return replace(
            light,
            position=triple(middle + rim * normal),
            intensity=(r, g, b),
            size=(across, along),
        )

    def _stand_ins(self) -> list[slice]:
        """Of each group, which of those points stand for it alone; else the one nearest to it."""
        # Which group each piece belongs to, and so the groups that each point stands for.
        owner = np.full(len(self._grouping.weights), -1, np.int64)
        for number, group in enumerate(self._groups):
            owner[group.rows] = number
        of_points = [owner[rows] for rows in self._scattering]
        found, spots = [], 0
        for number, group in enumerate(self._groups):
            # A spot light has four points on its ball, which lie in the order of groups.
            if group.spot >= 0:
                found.append(slice(4 * spots, 4 * spots + 4))
                spots += 1
                continue
            # Points of this group's pieces alone carry its power exactly, if they are one run.
            own = [k for k, by in enumerate(of_points) if (by == number).all()]
            if own and own[-1] - own[0] + 1 == len(own):
                found.append(slice(self._first_sample + own[0], self._first_sample + own[-1] + 1))
                continue
            # Else it shares points with other groups: the nearest one stands for it.
            centre = self._grouping.found.positions[group.rows].mean(axis=0)
            nearest = nearest_to(centre, self._places)
            found.append(slice(nearest, nearest + 1))
        return found

    def _radii(self) -> F64:
        """(n,) metres: of disks as large as the solid surfaces that pieces are parts of."""
        areas = np.bincount(self._grouping.cut.part, self._grouping.found.areas)
        is_solid = np.array([source.is_solid for source in self._grouping.sources], bool)
        radii = np.sqrt(areas / np.pi)[self._grouping.cut.part]
        return np.asarray(np.where(is_solid[self._grouping.cut.source], radii, 0.0))

    def _emitter(self, group: Group, stand_ins: slice) -> Emitter:
        shape = self._grouping.shape(group.rows)
        spot = self._grouping.sources[group.spot].spot if group.spot >= 0 else None
        count = stand_ins.stop - stand_ins.start
        is_outlined = self._grouping.is_outlined(group.rows, shape)
        samples, first = self._samples(group, 0), self.plain + stand_ins.start
        return Emitter(shape, samples, first, count, spot, is_outlined)

    def _samples(self, group: Group, index: int) -> tuple[Sample, ...]:
        """One for each stratum, those of a still's sample `index`."""
        parts = zip(group.strata, group.has_cube, strict=True)
        return tuple(
            self._sample(rows, k, index, has_cube=cube) for k, (rows, cube) in enumerate(parts)
        )

    def _sample(self, rows: I64, number: int, index: int, *, has_cube: bool) -> Sample:
        """What a stratum sends, from its middle; for later samples of a still, from a piece."""
        found = self._grouping.found
        own = found.taken(rows)
        # Pieces weigh by their power; by a little of their area, too, where all are dark.
        light = found.areas[rows, None] * found.radiance[rows]
        weight = light.sum(axis=1) + 1e-30 * found.areas[rows]
        weight = weight / max(float(weight.sum()), 1e-300)
        points, normals = found.positions[rows], found.normals[rows]
        middle = weight @ points
        mean = weight @ normals
        # Where normals cancel out any direction serves.
        length = float(np.linalg.norm(mean))
        normal = mean / length if length > 1e-6 else np.array((0.0, 1.0, 0.0))
        # How large it is: as a disk of its area, or as far as its light is spread.
        extent = float(np.sqrt(found.areas[rows].sum() / np.pi))
        spread = float(np.sqrt(weight @ ((points - middle) ** 2).sum(axis=1)))
        segment = long_part(own)
        bodies = self._grouping.cut.body[rows]
        share = chosen_share(index, number) if index else None
        if has_cube:
            middle = place_inside(points, weight, bodies, segment, share)
        elif (piece := piece_on_surface(points, weight, normal, extent, share)) is not None:
            middle, normal = points[piece], normals[piece] if index else normal
        # By Cauchy a convex body shows a quarter of its surface to all sides alike; only what its
        # normals have in common faces one side.
        front = length if has_cube else 1.0
        size = body(own, segment) if has_cube else rectangle(own, normal)
        near = own_reach(own, bodies, middle) if has_cube else np.zeros(3)
        r, g, b = light.sum(axis=0)
        sample = LightSample(
            triple(middle),
            triple(normal),
            (float(r), float(g), float(b)),
            front,
            (1.0 - length) / 4.0 if has_cube else 0.0,
            max(extent, spread),
            float(weight @ self._bodies[rows]),
            self._cell,
            triple(size.tangent),
            size.extent,
            triple(near),
        )
        return Sample(sample, min(max(extent, spread), float(near.max())), has_cube, segment)


def _spots(spot: SpotLight) -> list[SpotLight]:
    """Four spots on the ball of one, spread as its disk is."""
    side, up = orthonormal_frame(np.array(spot.direction))
    # The corners of a square as wide as the radius, a quarter of the power each.
    r, g, b = (0.25 * c for c in spot.intensity)
    return [
        replace(
            spot,
            position=triple(np.array(spot.position) + 0.5 * spot.radius * (x * side + y * up)),
            intensity=(r, g, b),
            radius=0.0,
        )
        for x, y in ((-1, -1), (1, -1), (-1, 1), (1, 1))
    ]
