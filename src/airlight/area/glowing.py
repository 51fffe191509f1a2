"""Media that give off light, as lights: blocks of voxels in groups of equal power.

A group is a sample that sends to all sides, as large as its voxels lie apart. Surfaces see each
through shadow maps and the media; lattices and media take a few as local lights.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import SettingsError
from ..maths.delta_beam import beam_loss
from ..maths.transforms import transformed, triple
from ..scene.checks import F64, I64
from ..scene.fingerprint import is_same
from ..scene.lights import LightSample
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume
from .emissive_blocks import Blocks, emissive_blocks
from .emitter import Emitter, Sample
from .places import chosen_share, up_to
from .shapes import Kind, Shape
from .strata import clusters, strata

EACH, MOST = 4, 12
"""Groups of one medium at least, if there is room, and of all at most."""
_APART = 0.7
"""Optical depths that a group reaches at most, the root mean square, where there are groups left.

What is nearer to the border of smoke than a group's middle counts for most of what leaves it. With
4 groups a fire of 3 mean free paths in smoke of 9 had .72 of its light, with 12 of them .92."""
_NEAREST = 0.3  # of a group's extent: what is nearer does not shadow it
_UP: F64 = np.array((0.0, 1.0, 0.0))
_CORE = 0.2
"""Of a group's extent: closer than that the media's light gets no brighter. Light that is cut off
there is missing: two thirds of what the media within a whole extent would scatter."""
_FAINT = 1e-3  # of the mean: blocks that are dark for now count as much


def grouped(blocks: Blocks, most: int) -> list[I64]:
    """Rows of blocks in at most `most` groups; media stay apart where there are not too many."""
    weight = blocks.weight + _FAINT * max(float(blocks.weight.mean()), 1e-30)
    count = int(blocks.volume.max()) + 1
    # More media than groups: whole media are put together.
    if count > most:
        return clusters(blocks.positions, weight, blocks.volume, most)
    total = float(weight.sum())
    found = []
    # Each medium has a group, and more of them by its share of the power.
    for one in range(count):
        rows = np.flatnonzero(blocks.volume == one)
        parts = 1 + int((most - count) * float(weight[rows].sum()) / total)
        found += [rows[part] for part in strata(blocks.positions[rows], weight[rows], parts)]
    return found


def wanted_groups(blocks: Blocks, scene: Scene) -> int:
    """How many groups are as thin as `_APART` for what keeps light in, `EACH` a medium at least."""
    loss, total = extinction_at(blocks.positions, scene, _beam_extinction)[:, 0], 0
    for one in range(int(blocks.volume.max()) + 1):
        rows = np.flatnonzero(blocks.volume == one)
        weight = _weight(blocks, rows)
        weight = weight / weight.sum()
        # A group's extent falls with the cube root of their number.
        depth = float(weight @ loss[rows]) * _extent(blocks, rows, weight)
        total += int(np.clip(np.ceil((depth / _APART) ** 3), EACH, MOST))
    return total


Extinction = Callable[[Medium | Volume], F64]
"""Of a medium at density 1, m^-1, (k,)."""


def extinction_at(points: F64, scene: Scene, of: Extinction) -> F64:
    """(n, k) m^-1, in all media, as `of` has it of each; voxels by the nearest one."""
    medium, found = scene.medium, np.zeros((len(points), 1))
    if medium is not None:
        found = found + of(medium)
    for volume in scene.volumes:
        # Where the points lie in the volume's box; outside there is nothing.
        low, high = np.array(volume.bounds)
        inverse = np.asarray(np.linalg.inv(volume.world_from_volume), np.float64)
        inside = transformed(points, inverse)
        place = (inside - low) / np.maximum(high - low, 1e-30)
        is_in = ((place >= 0.0) & (place <= 1.0)).all(axis=1)
        density = np.where(is_in, 1.0, 0.0)
        if volume.density is not None:
            size = np.array(volume.density.shape[::-1])
            x, y, z = np.clip((place * size).astype(np.int64), 0, size - 1).T
            density = density * volume.density[z, y, x]
        elif volume.shape == "sphere":
            density = np.where(((2.0 * place - 1.0) ** 2).sum(axis=1) <= 1.0, 1.0, 0.0)
        found = found + density[:, None] * of(volume)
    return found


def _beam_extinction(medium: Medium | Volume) -> F64:
    """Of beams, which keep what is scattered forwards, the mean channel (1,)."""
    loss = np.array(medium.sigma_t) * beam_loss(medium.g, medium.albedo)
    return np.asarray(loss.mean(keepdims=True), np.float64)


def _whole_extinction(medium: Medium | Volume) -> F64:
    """Of all light (3,)."""
    return np.array(medium.sigma_t, np.float64)


def split(blocks: Blocks, rows: I64, count: int) -> list[I64]:
    """A group's rows in `count` strata of equal power."""
    weight = blocks.weight[rows] + _FAINT * max(float(blocks.weight[rows].mean()), 1e-30)
    return [rows[part] for part in strata(blocks.positions[rows], weight, count)]


def light_of(blocks: Blocks, rows: I64, chosen: int | None = None) -> LightSample:
    """All that a group emits, from its middle; or from its block `chosen`, a row of `blocks`."""
    # By its blocks' power.
    weight = _weight(blocks, rows)
    weight = weight / weight.sum()
    middle = weight @ blocks.positions[rows]
    extent = _extent(blocks, rows, weight)
    at = middle if chosen is None else blocks.positions[chosen]
    x, y, z = (float(c) for c in at)
    r, g, b = (float(c) for c in blocks.intensity[rows].sum(axis=0))
    return LightSample((x, y, z), (0.0, 1.0, 0.0), (r, g, b), front=0.0, even=1.0, extent=extent)


def _weight(blocks: Blocks, rows: I64) -> F64:
    """What some of the blocks count for (n,): their power; a group that is dark for now stays."""
    weight = blocks.weight[rows]
    return np.asarray(weight + 1e-12 * max(float(weight.max()), 1e-30))


def _filling(light: LightSample, blocks: Blocks, rows: I64, extinction: F64) -> LightSample:
    """A group's light as media see it; `extinction` (n, 3), m^-1, at all blocks."""
    # Within the group light goes through what is there, the mean by power.
    weight = _weight(blocks, rows)
    depth = triple(light.extent * (weight @ extinction[rows]) / weight.sum())
    return replace(light, extent=_CORE * light.extent, spread=light.extent, inner_depth=depth)


def _extent(blocks: Blocks, rows: I64, weight: F64) -> float:
    """Of light around its middle, the root mean square, m; `weight` (n,) adds up to 1."""
    # Of blocks around the middle, and of the light within each of them.
    middle = weight @ blocks.positions[rows]
    apart = ((blocks.positions[rows] - middle) ** 2).sum(axis=1)
    return float(np.sqrt(weight @ (apart + blocks.variance[rows])))


@dataclass(frozen=True, eq=False)
class _Group:
    """Rows of blocks that are one emitter, cut into strata, of which each is one sample."""

    rows: I64
    strata: list[I64]


class GlowingMedia:
    """The emissive media of a scene in groups, which are decided once, for that scene."""

    def __init__(self, scene: Scene) -> None:
        self._blocks = emissive_blocks(scene)
        self._wanted = wanted_groups(self._blocks, scene) if self._blocks is not None else 0
        self.groups: list[_Group] = []
        self.lights: tuple[LightSample, ...] = ()
        """One for each group: what lattices and media take."""
        self._seen: tuple[object, ...] = ()

    @property
    def is_any(self) -> bool:
        """Whether any medium gives off light."""
        return self._blocks is not None

    @property
    def sample_count(self) -> int:
        """Samples of all groups."""
        return sum(len(group.strata) for group in self.groups)

    def group(self, samples: int, budget: int, room: int) -> None:
        """Decide the groups: `samples` for one medium, `budget` for many, `room` for all."""
        assert self._blocks is not None

        # As many groups as are wanted, samples by what the groups leave of the budget.
        media = int(self._blocks.volume.max()) + 1
        most = max(1, min(self._wanted, MOST, room))
        found = grouped(self._blocks, most)
        each = max(1, min(samples if media == 1 else budget, room) // len(found))
        self.groups = [_Group(rows, split(self._blocks, rows, each)) for rows in found]

    def take(self, scene: Scene) -> bool:
        """Take the emission of a frame; returns whether it changed."""
        if not self.groups:
            return False

        # Media are compared by identity: a changed one is another.
        seen = (scene.medium, *scene.volumes)
        if is_same(seen, self._seen):
            return False
        self._seen = seen
        # Buffers are made for as many blocks as the first scene has.
        blocks = emissive_blocks(scene)
        if blocks is None or len(blocks.volume) != len(self._blocks.volume if self._blocks else ()):
            raise SettingsError(
                "frame() got media that glow where the scene's did not, or other grids of them",
                remedy="Make a new Renderer",
            )
        self._blocks = blocks
        # The groups stay; how bright they are and where their middle is follows.
        extinction = extinction_at(blocks.positions, scene, _whole_extinction)
        self.lights = tuple(
            _filling(light_of(blocks, group.rows), blocks, group.rows, extinction)
            for group in self.groups
        )
        return True

    def emitters(self, first_row: int, index: int) -> tuple[Emitter, ...]:
        """One for each group, for sample `index` of a still; `first_row`: of their `lights`."""
        return tuple(
            Emitter(
                Shape(Kind.SAMPLES, np.array(light.position), _UP, np.array(light.intensity)),
                tuple(self._sample(rows, k, index) for k, rows in enumerate(group.strata)),
                first_row + number,
                is_medium=True,
            )
            for number, (group, light) in enumerate(zip(self.groups, self.lights, strict=True))
        )

    def _sample(self, rows: I64, number: int, index: int) -> Sample:
        assert self._blocks is not None
        chosen = None
        if index:
            # Later samples of a still lie anywhere in the stratum, by its power.
            chosen = int(rows[up_to(self._blocks.weight[rows], chosen_share(index, number))])
        light = light_of(self._blocks, rows, chosen)
        return Sample(light, _NEAREST * light.extent, is_cube=True)
